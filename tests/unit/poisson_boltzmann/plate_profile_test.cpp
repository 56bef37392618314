// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/plate_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pamr::poisson_boltzmann {
namespace plate_profile_test {

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

TEST(PlateProfile, LosesNoDigitsAtHighPotentials) {
  for (const double potential : {20.0, 40.0, 50.0, 100.0, 600.0}) {
    const PlateProfile profile(potential, 0, false);
    EXPECT_DOUBLE_EQ(profile.potential(0), potential);
    EXPECT_NEAR(profile.slope(0) / (-2 * std::sinh(potential / 2)), 1, 1e-12);
    // Beyond its layer the profile is that of an infinite potential, 2 log coth(z/2).
    for (const double z : {0.1, 1.0, 5.0, 40.0}) {
      const double limit = 2 * std::log1p(2 * std::exp(-z) / -std::expm1(-z));
      EXPECT_NEAR(profile.potential(z) / limit, 1, 1e-14 + 4 * std::exp(-potential / 2) * (1 + 1 / z))
          << potential << " " << z;
      EXPECT_NEAR(profile.slope(z) / (-2 * std::sinh(profile.potential(z) / 2)), 1, 1e-13);
    }
  }
}

TEST(PlateProfile, HasTheMeanSlopeOfItsDifferences) {
  const PlateProfile profile(-4, 0.5, false), linear(2, 0, true);
  EXPECT_NEAR(profile.mean_slope(0.5, 2), (profile.potential(2) + 4) / 1.5, 1e-14);
  EXPECT_NEAR(profile.mean_slope(2, 0.5), profile.mean_slope(0.5, 2), 1e-14);
  EXPECT_NEAR(profile.mean_slope(1, 1 + 1e-9), profile.slope(1), 1e-8);
  EXPECT_NEAR(linear.mean_slope(1, 1), linear.slope(1), 1e-14);
  EXPECT_LT(std::abs(PlateProfile(50, 0, false).mean_slope(0, 0.5)), 101);
}

}  // namespace plate_profile_test
}  // namespace pamr::poisson_boltzmann
