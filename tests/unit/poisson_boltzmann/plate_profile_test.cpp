// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/plate_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pamr::poisson_boltzmann {
namespace {

TEST(PlateProfile, TakesTheTabulatedValues) {
  const PlateProfile profile(5, 0, false);

  EXPECT_NEAR(profile.potential(0), 5, 1e-14);
  EXPECT_NEAR(profile.slope(0), -12.100408962, 1e-9);
  EXPECT_NEAR(profile.potential(0.1), 4.057434541, 1e-9);
  EXPECT_NEAR(profile.potential(0.5), 2.275377281, 1e-9);
  EXPECT_NEAR(profile.potential(1), 1.291331234, 1e-9);
  EXPECT_NEAR(profile.potential(2.5), 0.278976906, 1e-9);
  EXPECT_NEAR(profile.potential(5), 0.022863010, 1e-9);
}

TEST(PlateProfile, SatisfiesTheFirstIntegral) {
  const PlateProfile profile(-3, 0.5, false);
  for (const double z : {0.5, 0.75, 1.5, 4.0})
    EXPECT_NEAR(profile.slope(z) * profile.slope(z), 2 * (std::cosh(profile.potential(z)) - 1), 1e-10);
}

TEST(PlateProfile, DecaysExponentiallyWhereTheEquationIsLinear) {
  const PlateProfile profile(2, 1, true);

  EXPECT_DOUBLE_EQ(profile.potential(1), 2);
  EXPECT_DOUBLE_EQ(profile.potential(3), 2 * std::exp(-2.0));
  EXPECT_DOUBLE_EQ(profile.slope(3), -2 * std::exp(-2.0));
}

TEST(PlateProfile, IsZeroWithoutAPlate) {
  EXPECT_EQ(PlateProfile().potential(0.3), 0);
  EXPECT_EQ(PlateProfile().slope(0.3), 0);
}

}  // namespace
}  // namespace pamr::poisson_boltzmann
