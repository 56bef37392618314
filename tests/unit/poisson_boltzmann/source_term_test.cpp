// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/source_term.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pamr::poisson_boltzmann {
namespace source_term_test {

TEST(SourceTerm, IsTheDifferenceOfSinh) {
  const SourceTerm term(false);
  for (const double psi0 : {-2.0, 0.0, 1.5})
    for (const double u : {-1.0, 0.3, 4.0}) {
      EXPECT_NEAR(term.value(u, psi0), std::sinh(psi0 + u) - std::sinh(psi0), 1e-12);
      EXPECT_NEAR(term.pressure(u, psi0), std::cosh(psi0 + u) - std::cosh(psi0), 1e-12);
      EXPECT_NEAR(term.convex_rest(u, psi0), std::cosh(psi0 + u) - std::cosh(psi0) - u * std::sinh(psi0), 1e-12);
    }
}

TEST(SourceTerm, LosesNoDigitsWhereUIsSmall) {
  const SourceTerm term(false);
  const double u = 1e-9, psi0 = 3;

  EXPECT_NEAR(term.convex_rest(u, psi0) / (u * u / 2), std::cosh(psi0), 1e-8);
  EXPECT_NEAR(term.value(u, psi0) / u, std::cosh(psi0), 1e-8);
  // The two ways to sinh u - u meet at 1e-2.
  EXPECT_NEAR(term.convex_rest(0.00999999999, psi0) / term.convex_rest(0.01000000001, psi0), 1, 1e-8);
}

TEST(SourceTerm, StaysFiniteFarBeyondWhatSinhCanTake) {
  const SourceTerm term(false);

  EXPECT_TRUE(std::isfinite(term.value(1e6, 0)) && std::isfinite(term.value(-1e6, 0)));
  EXPECT_GT(term.value(400, 0), term.value(300, 0));
  EXPECT_DOUBLE_EQ(term.slope(1e6, 0), std::cosh(largest_argument));
}

TEST(SourceTerm, IsLinearOnRequest) {
  const SourceTerm term(true);

  EXPECT_EQ(term.value(3, 7), 3);
  EXPECT_EQ(term.slope(3, 7), 1);
  EXPECT_EQ(term.convex_rest(3, 7), 4.5);
  EXPECT_EQ(term.pressure(3, 7), 0.5 * (100 - 49));
}

TEST(SourceTerm, OfTwoEqualIonsIsSinh) {
  const SourceTerm ions(false, {{1, 3}, {-1, 3}}), sinh(false);
  for (const double psi0 : {-2.0, 0.0, 1.5})
    for (const double u : {-6.0, -1e-3, 1e-9, 0.3, 40.0}) {
      EXPECT_NEAR(ions.value(u, psi0) / sinh.value(u, psi0), 1, 1e-13);
      EXPECT_NEAR(ions.slope(u, psi0) / sinh.slope(u, psi0), 1, 1e-13);
      EXPECT_NEAR(ions.curvature(u, psi0) / sinh.curvature(u, psi0), 1, 1e-7);
      EXPECT_NEAR(ions.convex_rest(u, psi0) / sinh.convex_rest(u, psi0), 1, 1e-9);
      EXPECT_NEAR(ions.pressure_slope(u, psi0) / sinh.pressure_slope(u, psi0), 1, 1e-7);
      EXPECT_NEAR(ions.pressure(u, 0) / sinh.pressure(u, 0), 1, 1e-13);
      EXPECT_NEAR(ions.pressure(u, psi0), sinh.pressure(u, psi0), 1e-12 * std::cosh(u + psi0));
      EXPECT_NEAR(ions.layer_thickness(u), sinh.layer_thickness(u), 1e-13);
      EXPECT_NEAR(ions.potential_of_charge(u), sinh.potential_of_charge(u), 1e-13);
    }
}

TEST(SourceTerm, OfAnyIonsHasTheDerivativesThatItStatesAndTheChargeOfGrahame) {
  const double step = 1e-4;
  for (const auto& ions : {std::vector<Ion>{{2, 1}, {-1, 2}}, {{1, 1}, {-3, 1.0 / 3}}, {{1, 3}, {2, 1}, {-1, 5}}}) {
    const SourceTerm term(false, ions);
    EXPECT_NEAR(term.slope(0, 0), 1, 1e-15);
    for (const double psi : {-3.0, -0.2, 0.1, 2.5}) {
      const double slope = (term.value(psi + step, 0) - term.value(psi - step, 0)) / (2 * step);
      EXPECT_NEAR(term.slope(psi, 0), slope, 1e-6 * slope);
      EXPECT_NEAR(term.curvature(psi, 0), (term.slope(psi + step, 0) - term.slope(psi - step, 0)) / (2 * step),
                  1e-6 * slope);
      EXPECT_NEAR(term.pressure_slope(psi, 0),
                  (term.pressure(psi + step, 0) - term.pressure(psi - step, 0)) / (2 * step), 1e-6 * slope);
      double pressure = 0, squares = 0;
      for (const auto& ion : ions) {
        pressure += ion.concentration * (std::exp(-ion.charge * psi) - 1);
        squares += ion.concentration * ion.charge * ion.charge;
      }
      const double charge = std::copysign(std::sqrt(2 * pressure / squares), psi);
      EXPECT_NEAR(term.potential_of_charge(charge), psi, 1e-12);
    }
    EXPECT_TRUE(std::isfinite(term.value(1e6, 0)) && std::isfinite(term.value(-1e6, 0)));
    EXPECT_GT(term.value(400, 0), term.value(200, 0));
  }
}

}  // namespace source_term_test
}  // namespace pamr::poisson_boltzmann
