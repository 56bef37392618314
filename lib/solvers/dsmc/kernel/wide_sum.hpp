// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace pamr::dsmc {

/// A sum of integers of any size: two words, neither of which overflows within 2^39 additions, on all ranks together.
/// Sums are added and subtracted word by word; their words add up over ranks in any order.
struct WideSum {
  static constexpr int n_low = 24;
  static constexpr std::int64_t low_bits = (std::int64_t{1} << n_low) - 1;
  std::int64_t low = 0, high = 0;

  void add(std::int64_t value) {
    low += value & low_bits;
    high += value >> n_low;
  }
  WideSum& operator+=(const WideSum& other) {
    low += other.low;
    high += other.high;
    return *this;
  }
  WideSum& operator-=(const WideSum& other) {
    low -= other.low;
    high -= other.high;
    return *this;
  }
  /// The same sum with a low word from 0 to `low_bits`: one pair of words for each sum, however it was added up.
  WideSum settled() const { return {low & low_bits, high + (low >> n_low)}; }
  double value() const {
    return static_cast<double>(static_cast<long double>(high) * (low_bits + 1) + static_cast<long double>(low));
  }
};

}  // namespace pamr::dsmc
