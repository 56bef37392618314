// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/improve_node.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace pamr::meshing {
namespace improve_node_test {

using geometry::Vec3;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A tetrahedron cut into four by a node in it.
struct FourCells {
  std::vector<Vec3> point{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}, {}};
  std::vector<std::array<std::int32_t, 4>> cell{{4, 2, 1, 3}, {0, 2, 4, 3}, {0, 4, 1, 3}, {0, 2, 1, 4}};
};

double smallest_ratio(const FourCells& cells) {
  double least = infinity;
  for (const auto& c : cells.cell) {
    const auto p = [&](std::size_t k) { return cells.point[static_cast<std::size_t>(c[k])]; };
    least = std::min(least, geometry::mean_ratio({p(0), p(1), p(2), p(3)}));
  }
  return least;
}

const auto anywhere = [](Vec3 p) { return p; };
const auto ratio_itself = [](double ratio) { return ratio; };

TEST(ImproveNode, NeverMakesTheWorstCellWorseAndOftenMuchBetter) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> near(-0.33, 0.33);
  for (int i = 0; i < 200; ++i) {
    FourCells cells;
    cells.point[4] = {near(random), near(random), near(random)};
    const auto start = cells.point[4];
    const double before = smallest_ratio(cells);
    const Stars stars(cells.point, cells.cell);

    const bool has_moved = improve_node(stars, 4, before, anywhere, ratio_itself);

    const double after = smallest_ratio(cells);
    EXPECT_EQ(has_moved, !(cells.point[4] == start));
    if (has_moved)
      EXPECT_GT(after, before);
    else
      EXPECT_EQ(after, before);
    if (before < 0.2) {
      EXPECT_GT(after, 1.2 * before);
    }
  }
}

TEST(ImproveNode, StaysWhereItIsBoundAndWhereItsValueIsRefused) {
  FourCells cells;
  cells.point[4] = {0.3, 0.3, -0.3};
  const double before = smallest_ratio(cells);
  const Stars stars(cells.point, cells.cell);

  EXPECT_FALSE(improve_node(stars, 4, before, anywhere, [](double) { return refused; }));
  EXPECT_EQ(cells.point[4], (Vec3{0.3, 0.3, -0.3}));
  EXPECT_TRUE(improve_node(
      stars, 4, before,
      [](Vec3 p) {
        return Vec3{p.x, 0.3, p.z};
      },
      ratio_itself));
  EXPECT_EQ(cells.point[4].y, 0.3);
}

TEST(WorstRatio, IsTheSmallestOrSaysThatItIsNotAboveTheBound) {
  FourCells cells;
  cells.point[4] = {0.3, 0.3, -0.3};
  const Stars stars(cells.point, cells.cell);
  const double least = smallest_ratio(cells);

  EXPECT_EQ(worst_ratio(stars, 4, refused), least);
  EXPECT_EQ(worst_ratio(stars, 4, 0.5 * least), least);
  EXPECT_LE(worst_ratio(stars, 4, 0.9), 0.9);
  EXPECT_NEAR(shortest_edge(stars, 4), norm(Vec3{0.7, 0.7, 1.3}), 1e-15);
}

}  // namespace improve_node_test
}  // namespace pamr::meshing
