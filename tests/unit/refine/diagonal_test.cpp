// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/diagonal.hpp"

#include <gtest/gtest.h>

#include <random>

namespace pamr::refine {
namespace diagonal_test {

SplitPoints straight_cell(const geometry::TetPoints& corner) {
  SplitPoints points;
  for (std::size_t i = 0; i < 4; ++i) points[i] = corner[i];
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = mesh::tet::edge_to_corner[e];
    points[4 + e] = geometry::midpoint(corner[static_cast<std::size_t>(a)], corner[static_cast<std::size_t>(b)]);
  }
  return points;
}

double squared_length(const SplitPoints& points, int diagonal) {
  const auto d = static_cast<std::size_t>(diagonal);
  return geometry::squared_norm(points[4 + d] - points[9 - d]);
}

double worst_inner(const SplitPoints& points, int diagonal) {
  double worst = 1;
  for (int child = 4; child < 8; ++child)
    worst = std::min(worst, shape(child_points(points, regular_state + diagonal, child)));
  return worst;
}

/// Small whole coordinates: equal diagonals are common, and lengths are exact.
geometry::TetPoints random_lattice_cell(std::mt19937_64& random) {
  for (;;) {
    geometry::TetPoints corner;
    for (auto& p : corner)
      p = {static_cast<double>(random() % 4), static_cast<double>(random() % 4), static_cast<double>(random() % 4)};
    if (geometry::volume(corner) > 0) return corner;
  }
}

TEST(ChooseDiagonal, TakesTheShortestAndAmongEqualOnesTheBestWorstInnerCell) {
  std::mt19937_64 random(3);
  int n_tied = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const auto points = straight_cell(random_lattice_cell(random));

    const int chosen = choose_diagonal(points, true);

    ASSERT_TRUE(0 <= chosen && chosen < 3);
    for (int d = 0; d < 3; ++d) {
      EXPECT_LE(squared_length(points, chosen), squared_length(points, d));
      if (d == chosen || squared_length(points, chosen) != squared_length(points, d)) continue;
      ++n_tied;
      EXPECT_GE(worst_inner(points, chosen), worst_inner(points, d) * (1 - 1e-12));
    }
  }
  EXPECT_GT(n_tied, 100);
}

TEST(ChooseDiagonal, IsTheSameForStraightCellsWhicheverWayItIsAsked) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 3000; ++trial) {
    const auto points = straight_cell(random_lattice_cell(random));
    EXPECT_EQ(choose_diagonal(points, true), choose_diagonal(points, false));
  }
}

TEST(ChooseDiagonal, NamesADiagonalEvenWhereNoneGivesPositiveCells) {
  auto points = straight_cell({geometry::Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  for (std::size_t e = 0; e < 6; ++e) points[4 + e] = -1.0 * points[4 + e];
  const int chosen = choose_diagonal(points, false);
  EXPECT_TRUE(0 <= chosen && chosen < 3);
}

}  // namespace diagonal_test
}  // namespace pamr::refine
