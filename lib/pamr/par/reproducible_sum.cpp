// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/reproducible_sum.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace pamr::par {

namespace {

constexpr int digit_bits = 32;
constexpr std::uint64_t digit_mask = 0xffffffffU;
/// Each addend changes a word by less than 2^53, so that 2^9 of them fit beside a carried word.
constexpr std::int64_t max_since_carry = std::int64_t{1} << 9;

/// The 53 bits that begin at bit `from` of a number of 32-bit digits.
std::uint64_t bits_from(std::span<const std::int64_t> digit, int from) {
  std::uint64_t result = 0;
  for (int taken = 0; taken < 53;) {
    const int at = from + taken, shift = at % digit_bits;
    const auto part = (static_cast<std::uint64_t>(digit[static_cast<std::size_t>(at / digit_bits)]) & digit_mask) >>
                      static_cast<unsigned>(shift);
    result |= part << static_cast<unsigned>(taken);
    taken += digit_bits - shift;
  }
  return result & ((std::uint64_t{1} << 53U) - 1U);
}

bool has_bit(std::span<const std::int64_t> digit, int at) {
  return (digit[static_cast<std::size_t>(at / digit_bits)] >> (at % digit_bits) & 1) != 0;
}

bool has_bit_below(std::span<const std::int64_t> digit, int at) {
  const auto whole = static_cast<std::size_t>(at / digit_bits);
  if (std::any_of(digit.begin(), digit.begin() + static_cast<std::ptrdiff_t>(whole), [](auto d) { return d != 0; }))
    return true;
  return (static_cast<std::uint64_t>(digit[whole]) & ((std::uint64_t{1} << (at % digit_bits)) - 1U)) != 0;
}

}  // namespace

void ExactSum::add(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const auto exponent = static_cast<int>(bits >> 52U & 0x7ffU);
  const bool negative = bits >> 63U != 0;
  auto mantissa = bits & ((std::uint64_t{1} << 52U) - 1U);
  if (exponent == 0x7ff) {
    ++word_[mantissa != 0 ? not_a_number : negative ? minus_infinity : plus_infinity];
    return;
  }
  if (exponent != 0) mantissa |= std::uint64_t{1} << 52U;
  const int position = std::max(exponent, 1) - 1;  // weight of the last mantissa bit: 2^(position - 1074)
  const auto first = static_cast<std::size_t>(position / digit_bits);
  const auto shift = static_cast<unsigned>(position % digit_bits);
  // The mantissa is what fills the first digit and what is left, which may be wider than a digit until the next carry.
  const auto low = static_cast<std::int64_t>((mantissa << shift) & digit_mask);
  const auto high = static_cast<std::int64_t>(mantissa >> (digit_bits - shift));
  const std::int64_t sign = negative ? -1 : 0;  // x ^ -1 less -1 is -x: no branch that is mispredicted half of the time
  word_[first] += (low ^ sign) - sign;
  word_[first + 1] += (high ^ sign) - sign;
  if (++n_since_carry_ == max_since_carry) carry();
}

void ExactSum::carry() {
  for (std::size_t i = 0; i + 1 < n_digits; ++i) {
    const std::int64_t over = word_[i] >> digit_bits;  // rounds down: the digit left is not negative
    word_[i] -= over * (std::int64_t{1} << digit_bits);
    word_[i + 1] += over;
  }
  n_since_carry_ = 0;
}

double ExactSum::value() const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (word_[not_a_number] != 0 || (word_[plus_infinity] != 0 && word_[minus_infinity] != 0))
    return std::numeric_limits<double>::quiet_NaN();
  if (word_[plus_infinity] != 0) return infinity;
  if (word_[minus_infinity] != 0) return -infinity;
  ExactSum sum = *this;
  sum.carry();
  const bool negative = sum.word_[n_digits - 1] < 0;
  if (negative) {
    for (std::size_t i = 0; i < n_digits; ++i) sum.word_[i] = -sum.word_[i];
    sum.carry();
  }
  const std::span<const std::int64_t> digit(sum.word_.data(), n_digits);
  std::size_t top = n_digits;
  while (top > 0 && digit[top - 1] == 0) --top;
  if (top == 0) return 0.0;
  const auto width = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(digit[top - 1])));
  const int last = static_cast<int>(top - 1) * digit_bits + width - 1;
  const int from = std::max(last - 52, 0);
  auto mantissa = bits_from(digit, from);
  if (from > 0 && has_bit(digit, from - 1) && (has_bit_below(digit, from - 1) || (mantissa & 1U) != 0)) ++mantissa;
  const double size = std::ldexp(static_cast<double>(mantissa), from - 1074);
  return negative ? -size : size;
}

std::vector<double> reproducible_sums(const Comm& comm, std::span<ExactSum> sums) {
  std::vector<std::int64_t> words;
  words.reserve(sums.size() * ExactSum::n_words);
  for (auto& sum : sums) {
    sum.carry();  // after it 2^31 ranks can be added word by word
    words.insert(words.end(), sum.word_.begin(), sum.word_.end());
  }
  comm.sum_in_place(words);
  std::vector<double> result;
  result.reserve(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    ExactSum total;
    std::copy_n(words.begin() + static_cast<std::ptrdiff_t>(i * ExactSum::n_words), ExactSum::n_words,
                total.word_.begin());
    result.push_back(total.value());
  }
  return result;
}

double reproducible_sum(const Comm& comm, std::span<const double> values) {
  ExactSum sum;
  for (const double value : values) sum.add(value);
  return reproducible_sums(comm, std::span<ExactSum>(&sum, 1)).front();
}

}  // namespace pamr::par
