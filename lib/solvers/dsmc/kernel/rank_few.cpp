// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/rank_few.hpp"

#include <algorithm>
#include <cstring>

#include "pamr/base/contract.hpp"

namespace pamr::dsmc {

namespace {

constexpr std::size_t n_keys = 4;  ///< compared at a time: what every 64-bit processor does without a special version
static_assert(max_few % n_keys == 0);

using Keys = std::int32_t __attribute__((vector_size(n_keys * sizeof(std::int32_t))));

/// Halves of the numbers, which compare as signed ones in the same order.
struct Halves {
  std::array<std::int32_t, max_few> high, low;
};

Keys load(const std::int32_t* from) {
  Keys keys;
  std::memcpy(&keys, from, sizeof keys);
  return keys;
}
Keys all(std::int32_t key) { return Keys{key, key, key, key}; }
std::int32_t key_of(std::uint64_t half) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(half) ^ 0x80000000U);
}

/// Whether numbers are less than another one, and whether greater: -1 where true.
struct Comparison {
  Keys less, greater;
};

template <bool differ_in_high>
void count_before(const Halves& keys, std::size_t n, std::array<std::uint32_t, max_few>& rank) {
  constexpr Keys lane{0, 1, 2, 3};
  for (std::size_t first = 0; first < n; first += n_keys) {
    const Keys high = load(&keys.high[first]), low = load(&keys.low[first]);
    const auto compare = [&](std::size_t k) -> Comparison {
      const Keys other_high = all(keys.high[k]), other_low = all(keys.low[k]);
      const Keys less = low < other_low;
      const Keys greater = low > other_low;
      if constexpr (!differ_in_high) return {less, greater};
      const Keys same = high == other_high;
      return {(high < other_high) | (same & less), (high > other_high) | (same & greater)};
    };
    const auto end = std::min(n, first + n_keys);
    Keys count = all(static_cast<std::int32_t>(first));
    for (std::size_t k = 0; k < first; ++k) count += compare(k).less;
    for (std::size_t k = first; k < end; ++k) {
      const auto other = compare(k);
      count -= other.greater | (~other.less & (lane > all(static_cast<std::int32_t>(k - first))));
    }
    for (std::size_t k = end; k < n; ++k) count -= compare(k).greater;
    std::memcpy(&rank[first], &count, sizeof count);
  }
}

}  // namespace

void rank_few(std::span<const std::uint64_t> numbers, std::array<std::uint32_t, max_few>& rank) {
  PAMR_EXPECTS(numbers.size() <= max_few);
  Halves keys;
  std::uint64_t difference = 0;
  std::size_t n = 0;
  for (const auto number : numbers) {
    difference |= number ^ numbers[0];
    keys.high[n] = key_of(number >> 32U);
    keys.low[n] = key_of(number);
    ++n;
  }
  for (std::size_t k = n; k % n_keys != 0; ++k) keys.high[k] = keys.low[k] = 0;
  if (difference >> 32U == 0)
    count_before<false>(keys, n, rank);
  else
    count_before<true>(keys, n, rank);
}

}  // namespace pamr::dsmc
