// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/section_bounds.hpp"

#include <cmath>
#include <limits>

namespace pamr::dsmc {

SectionBounds::SectionBounds(const PairData& pair) {
  constexpr int bias = 1023, n_exponents = 2048;
  constexpr double rounding = 1e-12;  // of powers and products, amply
  of_exponent_.resize(n_exponents);
  for (int e = 1; e + 1 < n_exponents; ++e)
    of_exponent_[static_cast<std::size_t>(e)] =
        pair.weight * pair.coefficient * std::pow(std::ldexp(1.0, e - bias), pair.exponent);
  // Numbers below the least normal one, and infinity: both bounds are not numbers, and no comparison with them holds.
  of_exponent_.front() = of_exponent_.back() = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < n_parts; ++i) {
    const double from = 1 + static_cast<double>(i) / n_parts, to = 1 + static_cast<double>(i + 1) / n_parts;
    of_part_[i] = {std::pow(from, pair.exponent) * (1 - rounding), std::pow(to, pair.exponent) * (1 + rounding)};
  }
}

}  // namespace pamr::dsmc
