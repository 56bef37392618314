// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/quadratic_tet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "pamr/geometry/tet_shape.hpp"
#include "support/dice.hpp"
#include "support/quadratic_cell.hpp"

namespace pamr::geometry {
namespace quadratic_tet_test {

constexpr TetPoints reference{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

void move_mid(QuadraticTet& tet, std::size_t i, std::size_t j, Vec3 by) { tet[i][j] = tet[j][i] = tet[i][j] + by; }

/// A tetrahedron of any shape whose edges are bent by up to `bend` of their length.
QuadraticTet random_tet(test::Dice& dice, double bend) {
  TetPoints p = reference;
  for (auto& corner : p)
    for (std::size_t axis = 0; axis < 3; ++axis) corner[axis] += 0.2 * dice.symmetric();
  auto tet = straight_tet(p);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j)
      move_mid(tet, i, j, {bend * dice.symmetric(), bend * dice.symmetric(), bend * dice.symmetric()});
  return tet;
}

TEST(QuadraticTet, WithStraightEdgesHasTheJacobianOfTheLinearCell) {
  test::Dice dice(1);
  for (int n = 0; n < 100; ++n) {
    const auto tet = random_tet(dice, 0);
    const double straight = 6 * volume({tet[0][0], tet[1][1], tet[2][2], tet[3][3]});
    const auto bound = bound_jacobian(tet, 0);
    ASSERT_TRUE(bound.is_proved);
    EXPECT_EQ(bound.n_pieces, 1);
    EXPECT_NEAR(bound.lower, straight, 1e-11);
    EXPECT_LE(bound.lower, straight * (1 + 1e-15));
  }
}

TEST(QuadraticTet, IsProvedWhereSamplesSayThatItIsPositiveAndOnlyThere) {
  test::Dice dice(2);
  int n_proved = 0, n_folded = 0, n_cut = 0, n_folded_inside = 0;
  for (int n = 0; n < 3000; ++n) {
    const auto tet = random_tet(dice, 0.02 + 0.2 * dice.unit());
    const double straight = 6 * volume({tet[0][0], tet[1][1], tet[2][2], tet[3][3]});
    const double limit = n % 2 == 0 ? 0 : 0.1 * straight;
    const auto bound = bound_jacobian(tet, limit);
    const double sample = test::smallest_sample(tet, 12);
    if (bound.is_proved) {
      ++n_proved;
      n_cut += bound.n_pieces > 1 ? 1 : 0;
      ASSERT_GE(sample, limit);
      ASSERT_GE(sample, bound.lower);
      ASSERT_GT(bound.lower, 0);
    } else {
      ++n_folded;
      ASSERT_LT(sample, limit + 0.05 * straight) << "a sound cell was not proved";
      double at_corners = 1e300;
      for (std::size_t i = 0; i < 4; ++i) {
        test::Barycentric l{};
        l[i] = 1;
        at_corners = std::min(at_corners, test::sampled_jacobian(tet, l));
      }
      n_folded_inside += at_corners > limit ? 1 : 0;
    }
  }
  EXPECT_GT(n_proved, 500);
  EXPECT_GT(n_folded, 500);
  EXPECT_GT(n_cut, 20);
  EXPECT_GT(n_folded_inside, 10);  // sound in all corners, folded between them
}

/// Mean ratio of the tetrahedron that the Jacobian at a point makes.
double sampled_mean_ratio(const QuadraticTet& tet, const test::Barycentric& l) {
  return mean_ratio({Vec3{}, test::along_edge(tet, l, 1), test::along_edge(tet, l, 2), test::along_edge(tet, l, 3)});
}

TEST(QuadraticTet, HasLowerBoundsOfItsMapThatHoldAndAreClose) {
  test::Dice dice(4);
  constexpr int n_parts = 12;
  int n_positive = 0, n_folded = 0;
  for (int n = 0; n < 1000; ++n) {
    const auto tet = random_tet(dice, 0.02 + 0.2 * dice.unit());
    const auto bounds = bound_map(tet);
    const double smallest = test::smallest_sample(tet, n_parts);
    double smallest_ratio = 1;
    for (int i = 0; i <= n_parts; ++i)
      for (int j = 0; i + j <= n_parts; ++j)
        for (int k = 0; i + j + k <= n_parts; ++k) {
          const double h = 1.0 / n_parts;
          smallest_ratio =
              std::min(smallest_ratio, sampled_mean_ratio(tet, {h * (n_parts - i - j - k), h * i, h * j, h * k}));
        }
    ASSERT_LE(bounds.determinant.value, smallest);
    ASSERT_LE(bounds.mean_ratio.value, smallest_ratio);
    if (bounds.determinant.value > 0) {
      ++n_positive;
      EXPECT_LE(jacobian_at(tet, bounds.determinant.near), bounds.determinant.value / 0.98);
      EXPECT_LE(sampled_mean_ratio(tet, bounds.mean_ratio.near), bounds.mean_ratio.value / 0.98);
    } else {
      ++n_folded;
      EXPECT_EQ(bounds.mean_ratio.value, -1);
      EXPECT_LT(smallest, 0.02) << "a sound cell was not proved";
    }
  }
  EXPECT_GT(n_positive, 300);
  EXPECT_GT(n_folded, 100);
}

TEST(QuadraticTet, WithStraightEdgesHasItsOwnMeanRatioAsTheBound) {
  test::Dice dice(5);
  for (int n = 0; n < 100; ++n) {
    const auto tet = random_tet(dice, 0);
    const double own = mean_ratio({tet[0][0], tet[1][1], tet[2][2], tet[3][3]});
    const auto bounds = bound_map(tet);
    EXPECT_NEAR(bounds.mean_ratio.value, own, 1e-9);
    EXPECT_LE(bounds.mean_ratio.value, own);
    test::Barycentric middle{0.25, 0.25, 0.25, 0.25};
    EXPECT_LT(norm(point_at(tet, middle) - 0.25 * (tet[0][0] + tet[1][1] + tet[2][2] + tet[3][3])), 1e-15);
  }
}

TEST(QuadraticTet, HasThisJacobianAtAPoint) {
  test::Dice dice(3);
  for (int n = 0; n < 100; ++n) {
    const auto tet = random_tet(dice, 0.1);
    test::Barycentric l{dice.unit(), dice.unit(), dice.unit(), 0};
    l[3] = 1 - l[0] - l[1] - l[2];
    EXPECT_NEAR(jacobian_at(tet, l), test::sampled_jacobian(tet, l), 1e-12);
  }
}

TEST(QuadraticTet, WithAnEdgeBentPastItsOppositeIsNotProved) {
  auto tet = straight_tet(reference);
  ASSERT_TRUE(bound_jacobian(tet, 0).is_proved);
  move_mid(tet, 0, 1,
           {0, 0.24, 0});  // the tangent at corner 1 is along (1, -0.96, 0), that to corner 2 along (1, -1, 0)
  EXPECT_TRUE(bound_jacobian(tet, 0).is_proved);
  EXPECT_FALSE(bound_jacobian(tet, 0.1).is_proved);
  move_mid(tet, 0, 1, {0, 0.02, 0});
  EXPECT_FALSE(bound_jacobian(tet, 0).is_proved);
}

TEST(QuadraticTet, SoFlatThatRoundingHidesItsSignIsDecidedByExactArithmetic) {
  const TetPoints flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1.0 / 3, 1.0 / 3, 0x1p-60}}};
  EXPECT_FALSE(bound_jacobian(straight_tet(flat), 0).is_proved);
  EXPECT_TRUE(is_positive_exactly(straight_tet(flat)));
  EXPECT_FALSE(is_positive_exactly(straight_tet({flat[0], flat[2], flat[1], flat[3]})));
  EXPECT_FALSE(is_positive_exactly(straight_tet({flat[0], flat[1], flat[2], {1.0 / 3, 1.0 / 3, 0}})));
  // On a grid of the last place the middles of unit edges round to their ends: the cell folds.
  TetPoints far = reference;
  for (auto& p : far) p = p + Vec3{0x1p52, 0x1p52, 0x1p52};
  EXPECT_FALSE(bound_jacobian(straight_tet(far), 0).is_proved);
  EXPECT_FALSE(is_positive_exactly(straight_tet(far)));
}

TEST(QuadraticTet, ThatIsNotFiniteOrTooLargeIsNotProved) {
  auto tet = straight_tet(reference);
  tet[0][1].x = tet[1][0].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(bound_jacobian(tet, 0).is_proved);
  EXPECT_EQ(bound_map(tet).mean_ratio.value, -1);
  TetPoints large = reference;
  for (auto& p : large) p = 1e150 * p;
  EXPECT_FALSE(bound_jacobian(straight_tet(large), 0).is_proved);
  EXPECT_TRUE(is_positive_exactly(straight_tet(large)));
}

}  // namespace quadratic_tet_test
}  // namespace pamr::geometry
