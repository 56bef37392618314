// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "solvers/dsmc/gas/gas.hpp"

namespace pamr::dsmc {

/// Lower and upper bounds of weight times `section_times_speed` of a pair, from two short tables: they decide almost
/// every candidate pair without a power, and exactly as the power would.
class SectionBounds {
 public:
  explicit SectionBounds(const PairData& pair);

  struct Range {
    double low, high;  ///< 0.2 % apart for nitrogen
  };
  /// `speed_squared` >= 0.
  Range of(double speed_squared) const {
    const auto bits = std::bit_cast<std::uint64_t>(speed_squared);
    const auto part = (bits >> (52 - part_bits)) & (n_parts - 1);
    const double scale = of_exponent_[bits >> 52U];
    return {scale * of_part_[part].low, scale * of_part_[part].high};
  }

 private:
  static constexpr unsigned part_bits = 7;
  static constexpr std::size_t n_parts = std::size_t{1} << part_bits;
  std::vector<double> of_exponent_;  ///< at the powers of two; of 0 and what is hardly above: bounds that say nothing
  std::array<Range, n_parts> of_part_{};  ///< factors between a power of two and the next
};

}  // namespace pamr::dsmc
