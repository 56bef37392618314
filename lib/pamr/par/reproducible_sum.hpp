// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pamr/par/comm.hpp"

namespace pamr::par {

/// Sum of doubles without rounding: a fixed-point number wide enough for every finite double, in 32-bit digits held in
/// 64-bit words so that carries can wait. The value depends neither on the order of the addends nor on how they are
/// spread over ranks. 576 bytes; adding costs some five integer operations and no division.
/// Source: U. Kulisch, W. Miranker, "Computer Arithmetic in Theory and Practice", 1981 (the long accumulator).
class ExactSum {
 public:
  /// Adds a value. Not-a-number and infinities are remembered and make the sum what they would make any sum.
  void add(double value);

  /// The sum rounded once to the nearest double (ties to even): error at most half a unit in the last place of the
  /// exact sum.
  double value() const;

 private:
  friend std::vector<double> reproducible_sums(const Comm& comm, std::span<ExactSum> sums);

  /// Digit i weighs 2^(32 i - 1074): 66 digits reach the largest double, two more take 2^64 addends.
  static constexpr std::size_t n_digits = 68;
  static constexpr std::size_t n_words = n_digits + 3;
  static constexpr std::size_t not_a_number = n_digits, plus_infinity = n_digits + 1, minus_infinity = n_digits + 2;

  void carry();

  std::array<std::int64_t, n_words> word_{};
  std::int64_t n_since_carry_ = 0;
};

/// Sum over all values of all ranks, the same bits for every order, partition and number of ranks: exact inside,
/// rounded once. Collective: one reduction of 71 integers. O(values) time, no memory.
double reproducible_sum(const Comm& comm, std::span<const double> values);

/// Several sums at once, each over all ranks: `result[i]` is the total of `sums[i]`. Every rank gives the same number
/// of sums. Collective: one reduction of 71 integers a sum.
std::vector<double> reproducible_sums(const Comm& comm, std::span<ExactSum> sums);

}  // namespace pamr::par
