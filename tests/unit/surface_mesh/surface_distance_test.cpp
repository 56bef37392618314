// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/surface_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pamr/base/index.hpp"
#include "pamr/geometry/triangulated/triangle_tree.hpp"
#include "support/triangulations.hpp"
#include "surface_mesh/change_scale.hpp"

namespace pamr::surface_mesh {
namespace surface_distance_test {

using geometry::Vec3;

TEST(SurfaceDistance, IsZeroFromASurfaceToItself) {
  const auto ball = testing::icosphere(2);

  const auto d = distance_from_to(ball, ball, {.enough = 1e-6});

  EXPECT_LT(d.at_least, 1e-15);
  EXPECT_LT(d.at_most, 1e-6);
  EXPECT_TRUE(d.far.empty());
}

TEST(SurfaceDistance, KnowsThatTheMiddleOfATriangleIsFarthest) {
  // A roof over a flat square: the ridge point is 1 above, all corners are on it.
  const geometry::Triangulation flat{
      .name = {}, .points = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}, .triangles = {{0, 1, 2}, {0, 2, 3}}};
  auto roof = flat;
  roof.points.push_back({1, 1, 1});
  roof.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};

  const auto up = distance_from_to(roof, flat), down = distance_from_to(flat, roof);

  EXPECT_EQ(up.at_least, 1);
  EXPECT_LE(up.at_most, 1.02);
  // The point under the ridge is farthest from the roof: 1 / sqrt(2) from each of its sides.
  EXPECT_NEAR(down.at_least, std::sqrt(0.5), 0.02);
  EXPECT_GE(down.at_most, std::sqrt(0.5));
  EXPECT_LE(down.at_most, 1.02 * std::sqrt(0.5) + 1e-12);
}

TEST(SurfaceDistance, NamesTrianglesOfWhichNothingIsProved) {
  auto ball = testing::icosphere(3), other = ball;
  translate(other, {0.002, 0, 0});

  const auto cut_short = distance_from_to(ball, other, {.enough = 0.00195, .max_queries = 0});
  const auto whole = distance_from_to(ball, other, {.enough = 0.0021});

  EXPECT_GT(cut_short.at_most, 0.00195);
  EXPECT_FALSE(cut_short.far.empty());
  EXPECT_LE(whole.at_most, 0.0021);
  EXPECT_TRUE(whole.far.empty());
}

TEST(SurfaceDistance, BoundsWhatDenseSamplesFind) {
  const auto coarse = testing::icosphere(1);
  auto fine = testing::icosphere(3);
  translate(fine, {0.01, -0.02, 0.005});
  std::vector<std::array<Vec3, 3>> corners;
  for (const auto& [a, b, c] : fine.triangles)
    corners.push_back({fine.points[at(a)], fine.points[at(b)], fine.points[at(c)]});
  const geometry::TriangleTree tree(corners);
  double worst = 0;
  constexpr int n = 40;
  for (const auto& [a, b, c] : coarse.triangles)
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const Vec3 o = coarse.points[at(a)];
        const Vec3 p = o + (1.0 * i / n) * (coarse.points[at(b)] - o) + (1.0 * j / n) * (coarse.points[at(c)] - o);
        const auto [t, u, v] = tree.nearest(p);
        const auto& q = corners[at(t)];
        worst = std::max(worst, norm(p - q[0] - u * (q[1] - q[0]) - v * (q[2] - q[0])));
      }

  const auto d = distance_from_to(coarse, fine);

  EXPECT_GE(d.at_most, worst);
  EXPECT_GE(d.at_least, 0.97 * worst);
  EXPECT_LE(d.at_most, 1.03 * d.at_least);
}

TEST(SurfaceDistance, DoesNotTakeATriangleForNearBecauseItsCornersAre) {
  // A triangle with sides of 1 over three specks at its corners: its middle is 1 / sqrt(3) from each of them.
  const double height = std::sqrt(0.75);
  const geometry::Triangulation whole{
      .name = {}, .points = {{0, 0, 0}, {1, 0, 0}, {0.5, height, 0}}, .triangles = {{0, 1, 2}}};
  auto specks = whole;
  specks.triangles.clear();
  for (int k = 0; k < 3; ++k) {
    const int n = static_cast<int>(specks.points.size());
    const Vec3 p = specks.points[at(k)];
    specks.points.push_back(p + Vec3{1e-6, 0, 1e-6});
    specks.points.push_back(p + Vec3{0, 1e-6, 1e-6});
    specks.triangles.push_back({k, n, n + 1});
  }

  const auto d = distance_from_to(whole, specks, {.enough = 0.55});

  EXPECT_GT(d.at_most, 0.57);
  EXPECT_FALSE(d.far.empty());
}

}  // namespace surface_distance_test
}  // namespace pamr::surface_mesh
