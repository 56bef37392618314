// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/sorted_order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

#include "pamr/base/memory.hpp"

namespace pamr {

namespace {

constexpr unsigned bits_of_digit = 8;
constexpr std::size_t n_values = std::size_t{1} << bits_of_digit;
constexpr std::size_t n_digits = 32 / bits_of_digit;

/// The leading 32 bits of a key, and below them its index: half the memory traffic of sorting keys and indices.
using Word = std::uint64_t;

std::size_t digit_of(Word word, std::size_t digit) {
  return static_cast<std::size_t>(word >> (32U + bits_of_digit * digit)) & (n_values - 1);
}

/// Sorts by the upper halves, from the lowest digit to the highest; a digit that is the same in all is left out.
void radix_sort(std::vector<Word>& words) {
  std::array<std::array<std::size_t, n_values>, n_digits> begin{};
  for (const auto word : words)
    for (std::size_t d = 0; d < n_digits; ++d) ++begin[d][digit_of(word, d)];
  std::vector<Word> other;
  assign_array(other, words.size(), Word{0});
  for (std::size_t d = 0; d < n_digits; ++d) {
    if (std::find(begin[d].begin(), begin[d].end(), words.size()) != begin[d].end()) continue;
    std::size_t sum = 0;
    for (auto& at : begin[d]) {
      const auto count = at;
      at = sum;
      sum += count;
    }
    for (const auto word : words) other[begin[d][digit_of(word, d)]++] = word;
    words.swap(other);
  }
}

}  // namespace

std::vector<std::uint32_t> sorted_order(std::span<const std::uint64_t> key) {
  std::uint64_t used = 1;
  for (const auto k : key) used |= k;
  const auto unused = static_cast<unsigned>(std::countl_zero(used));
  std::vector<Word> words;
  reserve_array(words, key.size());
  for (std::size_t i = 0; i < key.size(); ++i) words.push_back((key[i] << unused >> 32U << 32U) | i);
  radix_sort(words);

  std::vector<std::uint32_t> order;
  reserve_array(order, key.size());
  for (const auto word : words) order.push_back(static_cast<std::uint32_t>(word));
  for (std::size_t begin = 0, end = 0; begin < words.size(); begin = end) {
    const auto leading = words[begin] >> 32U;
    for (end = begin + 1; end < words.size() && words[end] >> 32U == leading;) ++end;
    if (end - begin > 1)
      std::sort(order.begin() + static_cast<std::ptrdiff_t>(begin), order.begin() + static_cast<std::ptrdiff_t>(end),
                [&](std::uint32_t a, std::uint32_t b) { return key[a] != key[b] ? key[a] < key[b] : a < b; });
  }
  return order;
}

}  // namespace pamr
