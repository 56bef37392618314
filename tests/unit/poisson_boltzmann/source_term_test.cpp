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

}  // namespace source_term_test
}  // namespace pamr::poisson_boltzmann
