// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/site_charge.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace pamr::poisson_boltzmann {
namespace site_charge_test {

/// Half of the sites carry their charge at psi = +-1; of a 2:2 salt the last.
const std::array<SiteCharge, 3> kinds{{{-4, -1, -1}, {3, 2, 1}, {5, 0.5, 0.5}}};

TEST(SiteCharge, FollowsTheLawOfMassAction) {
  // pH 6, pK 5, acid: ten sites without a proton for each with one, at no potential.
  const SiteCharge acid{-4, -std::numbers::ln10, -1};
  EXPECT_NEAR(acid.value(0), -4 * 10.0 / 11, 1e-14);
  EXPECT_NEAR(acid.value(-std::numbers::ln10), -2, 1e-14);
  const SiteCharge base{2, std::numbers::ln10, 1};
  EXPECT_NEAR(base.value(0), 2 / 11.0, 1e-14);
}

TEST(SiteCharge, HasTheSlopesOfItsValueAndOfItsFreeEnergy) {
  const double h = 1e-5;
  for (const auto& site : kinds)
    for (const double psi : {-3.0, -0.2, 0.0, 1.7}) {
      EXPECT_NEAR(site.slope(psi), (site.value(psi + h) - site.value(psi - h)) / (2 * h), 1e-8);
      EXPECT_NEAR(site.curvature(psi), (site.slope(psi + h) - site.slope(psi - h)) / (2 * h), 1e-8);
      EXPECT_NEAR(site.value(psi), (site.integral(psi + h) - site.integral(psi - h)) / (2 * h), 1e-8);
      EXPECT_LE(site.slope(psi), 0);
      EXPECT_EQ(site.integral(0), 0);
    }
}

TEST(SiteCharge, StaysFiniteFarBeyondWhatExpCanTake) {
  for (const auto& site : kinds)
    for (const double psi : {-1e5, 1e5})
      for (const double number : {site.value(psi), site.slope(psi), site.curvature(psi), site.integral(psi)})
        EXPECT_TRUE(std::isfinite(number)) << psi;
  EXPECT_DOUBLE_EQ(kinds[0].value(1e5), -4);  // all
  EXPECT_EQ(kinds[0].value(-1e5), 0);
}

TEST(SiteCharge, AloneOnAFlatWallIsTheChargeThatSuchAWallNeeds) {
  for (const auto& site : kinds)
    for (const auto& term : {SourceTerm(false), SourceTerm(true), SourceTerm(false, {{2, 1}, {-1, 2}})}) {
      const double psi = site.flat_wall_potential(term);
      EXPECT_NEAR(std::abs(site.value(psi)), term.flat_wall_slope(psi), 1e-12);
      EXPECT_GT(site.density * psi, 0);
    }
}

}  // namespace site_charge_test
}  // namespace pamr::poisson_boltzmann
