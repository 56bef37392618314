// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/units.hpp"

#include <gtest/gtest.h>

namespace pamr::poisson_boltzmann {
namespace units_test {

TEST(Units, TheForceUnitHoldsNoLength) {
  EXPECT_NEAR(units_of({"1:1", 1, 298.15, 78.5, {}}).force, 4.58811e-13, 1e-18);
  EXPECT_NEAR(units_of({"1:1", 1, 300, 80, {}}).force, 4.73399e-13, 1e-18);
  EXPECT_NEAR(units_of({"1:1", 1, 293.15, 80.1, 1e-6}).force, 4.52592e-13, 1e-18);
  EXPECT_NEAR(units_of({"2:2", 2, 298.15, 78.5, {}}).force, 4.58811e-13 / 4, 1e-18);
}

TEST(Units, TheDebyeLengthAndTheSaltDetermineEachOther) {
  Electrolyte water;
  water.debye_length = 0.275e-6;

  const double salt = *units_of(water).concentration;

  EXPECT_NEAR(salt, 1.22e-3, 0.01e-3);  // mol/m^3: 7.37e20 ions of each kind in a cubic meter
  EXPECT_NEAR(debye_length(water, salt), 0.275e-6, 1e-15);
  EXPECT_NEAR(debye_length(Electrolyte{}, 1), 9.62e-9, 0.01e-9);
}

TEST(Units, WhatHoldsALengthNeedsTheDebyeLength) {
  const auto units = units_of(Electrolyte{});

  EXPECT_FALSE(units.length || units.charge || units.charge_density || units.energy || units.concentration);
}

}  // namespace units_test
}  // namespace pamr::poisson_boltzmann
