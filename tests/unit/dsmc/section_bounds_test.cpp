// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/section_bounds.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/dice.hpp"

namespace pamr::dsmc {
namespace section_bounds_test {

TEST(SectionBounds, EnclosePowersTightly) {
  Gas gas;
  gas.species = {{"N2", 4.65e-26, 4.17e-10, 0.74, 273, 1, 2},
                 {"hard", 6.63e-26, 4.11e-10, 0.5, 273, 1, 0},
                 {"Maxwell", 2e-26, 2e-10, 1, 273, 1, 0}};
  gas.species[1].weight = 0.01;
  gas.fraction = {0.4, 0.3, 0.3};
  prepare(gas);
  test::Dice dice(5);
  for (const auto& pair : gas.pairs) {
    const SectionBounds bounds(pair);
    for (int k = 0; k < 2000; ++k) {
      double speed_squared = std::pow(10, -20 + 40 * dice.unit());
      if (k % 4 == 0)
        speed_squared = std::ldexp(1 + static_cast<double>(k % 128) / 128, k % 60 - 20);  // where they meet
      const double exact = pair.weight * section_times_speed(pair, speed_squared);
      const auto range = bounds.of(speed_squared);
      EXPECT_LE(range.low, exact);
      EXPECT_GE(range.high, exact);
      EXPECT_LT(range.high - range.low, 0.0045 * exact);
    }
  }
}

TEST(SectionBounds, DecideNothingWhereTheyDoNotHold) {
  Gas gas;
  gas.species = {{"N2", 4.65e-26, 4.17e-10, 0.74, 273, 1, 2}};
  gas.fraction = {1};
  prepare(gas);
  const SectionBounds bounds(gas.pairs[0]);

  for (const double outside : {0.0, 1e-310, std::numeric_limits<double>::infinity()}) {
    const auto range = bounds.of(outside);
    EXPECT_FALSE(range.high <= 1e300 || range.low > 0);
  }
}

}  // namespace section_bounds_test
}  // namespace pamr::dsmc
