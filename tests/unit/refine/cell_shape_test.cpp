// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/cell_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include "pamr/refine/diagonal.hpp"

namespace pamr::refine {
namespace cell_shape_test {

double worst_ratio(const SplitPoints& points, int state) {
  double worst = 1;
  for (int c = 0; c < split_pattern[at(state)].n_children; ++c)
    worst = std::min(worst, geometry::mean_ratio(child_points(points, state, c)));
  return worst;
}

/// Cells from nearly regular to poor, and now and then one with whole coordinates, where edges are equally long.
geometry::TetPoints random_cell(std::mt19937& random) {
  std::uniform_real_distribution<double> jitter(-0.45, 0.45);
  for (;;) {
    const bool is_lattice = random() % 4 == 0;
    geometry::TetPoints p{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (auto& corner : p) {
      if (is_lattice)
        corner = {static_cast<double>(random() % 3), static_cast<double>(random() % 3),
                  static_cast<double>(random() % 3)};
      else
        corner = corner + geometry::Vec3{jitter(random), jitter(random), jitter(random)};
    }
    if (geometry::mean_ratio(p) > 0.05) return p;
  }
}

constexpr std::array<geometry::Vec3, 4> kuhn{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}}};

TEST(CellShape, KnowsTheShapesOfAllStatesFromTheEdgesAlone) {
  std::mt19937 random(3);
  for (int sample = 0; sample < 50; ++sample) {
    const auto corner = random_cell(random);
    const CellShape shape(corner);
    const auto points = straight_points(corner);
    for (int s = 1; s < regular_state; ++s) EXPECT_NEAR(std::cbrt(shape.of_state(s)), worst_ratio(points, s), 1e-12);
    const int regular = regular_state + choose_diagonal(points, true);
    EXPECT_NEAR(std::cbrt(shape.of_regular_split()), worst_ratio(points, regular), 1e-12);
  }
}

TEST(CellShape, KnowsTheKuhnCell) {
  const CellShape shape(kuhn);
  const auto best = [&](unsigned marks) { return std::cbrt(shape.of_marks(static_cast<EdgeMask>(marks))); };
  const auto bit = [](int a, int b) { return 1U << mesh::tet::edge_of[at(a)][at(b)]; };
  EXPECT_NEAR(best(bit(0, 3)), 0.762, 5e-4);
  EXPECT_NEAR(best(bit(0, 2)), 0.560, 5e-4);
  EXPECT_NEAR(best(bit(0, 1) | bit(1, 2) | bit(0, 2)), 0.387, 5e-4);
  EXPECT_NEAR(best(bit(0, 1) | bit(1, 2) | bit(0, 2) | bit(0, 3)), 0.545, 5e-4);
}

TEST(CellShape, CutsFacesFromTheLongerEdge) {
  std::mt19937 random(5);
  for (int sample = 0; sample < 200; ++sample) {
    const auto corner = random_cell(random);
    const CellShape shape(corner);
    const auto length = [&](int e) {
      const auto [a, b] = mesh::tet::edge_to_corner[at(e)];
      return geometry::norm(corner[at(a)] - corner[at(b)]);
    };
    for (unsigned mask = 1; mask < all_edges; ++mask) {
      const unsigned cuts = shape.cuts(static_cast<EdgeMask>(mask));
      EXPECT_NE(states_of_marks[mask][cuts].state[0], 0) << "straight lengths are in one order";
      for (int f = 0; f < 4; ++f) {
        const unsigned two = mask & mesh::tet::face_edge_mask[at(f)];
        if (std::popcount(two) != 2) {
          EXPECT_EQ(cuts >> f & 1U, 0U);
          continue;
        }
        const double lower = length(std::countr_zero(two)), higher = length(std::bit_width(two) - 1);
        if (std::abs(lower - higher) > 1e-9) {
          EXPECT_EQ((cuts >> f & 1U) != 0, higher > lower);
        }
      }
    }
  }
}

TEST(CellShape, DoesNotDependOnTheOrderOfTheCorners) {
  std::mt19937 random(7);
  constexpr std::array<int, 4> turn{1, 2, 0, 3};  // slot i of the turned cell has corner turn[i]
  for (int sample = 0; sample < 200; ++sample) {
    const auto corner = random_cell(random);
    geometry::TetPoints turned;
    for (int i = 0; i < 4; ++i) turned[at(i)] = corner[at(turn[at(i)])];
    const CellShape shape(corner), other(turned);
    const auto turn_mask = [&](unsigned mask) {
      unsigned result = 0;
      for (int e = 0; e < 6; ++e) {
        const auto [a, b] = mesh::tet::edge_to_corner[at(e)];
        if ((mask >> mesh::tet::edge_of[at(turn[at(a)])][at(turn[at(b)])] & 1U) != 0) result |= 1U << e;
      }
      return static_cast<EdgeMask>(result);
    };
    for (unsigned mask = 1; mask < all_edges; ++mask) {
      const auto marks = static_cast<EdgeMask>(mask);
      for (const double floor : {0.0, 0.3, 0.5})
        EXPECT_EQ(turn_mask(shape.closed_marks(marks, floor)), other.closed_marks(turn_mask(mask), floor));
      const auto& first = mesh::closure_states[at(shape.best_state(marks))];
      const auto& second = mesh::closure_states[at(other.best_state(turn_mask(mask)))];
      EXPECT_EQ(first.family.n_children, second.family.n_children);
      EXPECT_EQ(first.inner_edge < 0, second.inner_edge < 0);
    }
  }
}

TEST(CellShape, ClosedMarksAreTheLeastSetThatObeysTheFloor) {
  std::mt19937 random(11);
  int n_grown = 0, n_red = 0;
  for (int sample = 0; sample < 300; ++sample) {
    const auto corner = random_cell(random);
    const CellShape shape(corner);
    const auto points = straight_points(corner);
    for (const double floor : {0.2, 0.35, 0.5, 0.68}) {
      const double reach = std::min(floor, worst_ratio(points, regular_state + choose_diagonal(points, true)));
      std::array<EdgeMask, 64> closed{};
      for (unsigned m = 0; m < 64; ++m) closed[m] = shape.closed_marks(static_cast<EdgeMask>(m), floor);
      EXPECT_EQ(closed[0], 0);
      for (unsigned a = 0; a < 64; ++a) {
        EXPECT_EQ(closed[a] & a, a);
        EXPECT_EQ(closed[closed[a]], closed[a]);
        n_grown += closed[a] != a ? 1 : 0;
        n_red += closed[a] == all_edges && a != all_edges ? 1 : 0;
        if (closed[a] != 0 && closed[a] != all_edges) {
          EXPECT_GE(worst_ratio(points, shape.best_state(closed[a])), reach * (1 - 1e-9));
        }
        for (unsigned b = 0; b < 64; ++b)
          if ((a & b) == a) {
            EXPECT_EQ(closed[a] & closed[b], closed[a]) << "not monotone";
          }
      }
    }
  }
  EXPECT_GT(n_grown, 1000);
  EXPECT_GT(n_red, 100);
}

TEST(CellShape, KeepsOldCutsAndGoesOnWhereTheyLeaveNoWay) {
  const CellShape plain(kuhn);
  constexpr EdgeMask at_corner = 0x07;  // the three edges at corner 0, in faces 1, 2 and 3
  const unsigned cuts = plain.cuts(at_corner);
  for (int f = 1; f < 4; ++f) {
    const auto two = static_cast<EdgeMask>(at_corner & mesh::tet::face_edge_mask[at(f)]);
    const CellShape other(kuhn, {two, (cuts ^ 1U << f) & 1U << f});
    EXPECT_EQ(other.cuts(two), (cuts ^ 1U << f) & 1U << f);
    const unsigned mixed = other.cuts(at_corner);
    EXPECT_EQ(mixed, cuts ^ 1U << f);
    const auto required = other.closed_marks(at_corner, 0);
    if (states_of_marks[at_corner][mixed].state[0] == 0) {
      EXPECT_NE(required, at_corner);
      EXPECT_TRUE(required == all_edges || other.best_state(required) != 0);
    } else {
      EXPECT_EQ(required, at_corner);
    }
  }
}

}  // namespace cell_shape_test
}  // namespace pamr::refine
