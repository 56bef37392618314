// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/describe.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "support/triangulations.hpp"

namespace pamr::surface_mesh {
namespace describe_test {

using geometry::Triangulation;

TEST(Describe, KnowsTheMeasuresOfACube) {
  const auto cube = testing::bored_cube(8);

  const auto d = describe(cube);

  // An octagon in a circle of radius 0.5 is bored out.
  const double bore = 8 * 0.5 * 0.25 * std::sin(std::numbers::pi / 4), side = std::sin(std::numbers::pi / 8);
  EXPECT_NEAR(d.volume, 8 - 2 * bore, 1e-12);
  EXPECT_NEAR(d.area, 24 - 2 * bore + 8 * side * 2, 1e-12);
  EXPECT_TRUE(d.is_body());
  EXPECT_EQ(d.sharp_edges, 12 + 2 * 8 + 8);
  EXPECT_EQ(d.shells.size(), 1U);
  ASSERT_TRUE(d.deviation);
  EXPECT_EQ(faults_of(d), std::vector<std::string>{});
}

TEST(Describe, MeasuresHowFarFacetsAreOffTheSphere) {
  const auto d = describe(testing::icosphere(3));

  ASSERT_TRUE(d.deviation);
  // The middle of a facet of circumradius a is 1 - sqrt(1 - a^2) inside; edges are 0.14 to 0.16 long.
  EXPECT_GT(d.deviation->mean, 2e-3);
  EXPECT_LT(d.deviation->worst, 5e-3);
}

TEST(Describe, CountsOpenEdgesAndLoops) {
  auto ball = testing::icosphere(2);
  const auto corner = ball.triangles.front();
  std::erase_if(ball.triangles, [&](const auto& t) { return t == corner; });
  ball.triangles.pop_back();

  const auto d = describe(ball);

  EXPECT_EQ(d.open_edges.count, 6);
  EXPECT_EQ(d.loops.size(), 2U);
  EXPECT_TRUE(d.is_surface());
  EXPECT_FALSE(d.is_body());
  EXPECT_EQ(faults_of(d).size(), 1U);
}

TEST(Describe, FindsEveryKindOfDefect) {
  auto ball = testing::icosphere(1);
  std::swap(ball.triangles[0][1], ball.triangles[0][2]);
  ball.triangles.push_back(ball.triangles[20]);
  ball.triangles.push_back({ball.triangles[5][0], ball.triangles[5][0], ball.triangles[5][1]});
  ball.points.push_back({5, 5, 5});
  ball.points.push_back(ball.points[3]);
  ball.points.push_back({2, 2, 2});
  const int fin = static_cast<int>(ball.points.size()) - 1;
  ball.triangles.push_back({ball.triangles[40][0], ball.triangles[40][1], fin});

  const auto d = describe(ball);

  EXPECT_EQ(d.turned_edges.count, 3);
  EXPECT_EQ(d.duplicate_triangles.count, 1);
  EXPECT_EQ(d.flat_triangles.count, 1);
  EXPECT_EQ(d.unused_points.count, 2);
  EXPECT_EQ(d.coincident_points.count, 0);  // the copy is not used
  EXPECT_EQ(d.non_manifold_edges.count, 3 + 1);
  EXPECT_EQ(d.open_edges.count, 2);
  EXPECT_FALSE(d.is_surface());
  EXPECT_FALSE(d.self_intersections);
}

TEST(Describe, FindsAPointWhereTwoFansMeet) {
  auto two = testing::icosphere(0);
  const auto n = static_cast<int>(two.points.size());
  const auto touch = two.points[0];
  const auto other = two;
  for (const auto p : other.points) two.points.push_back(2.0 * touch - p);  // the mirror image through a point
  for (const auto& [a, b, c] : other.triangles) two.triangles.push_back({a + n, c + n, b + n});
  for (auto& t : two.triangles)
    for (int& p : t) p = p == n ? 0 : p;

  const auto d = describe(two);

  EXPECT_EQ(d.non_manifold_points.count, 1);
  EXPECT_EQ(d.shells.size(), 2U);
}

TEST(Describe, CallsNestedShellsABodyOnlyIfTheyFaceOutwardsAndInwardsInTurn) {
  const auto nested = [](bool middle_turned, bool core_turned) {
    Triangulation all;
    for (const double radius : {3.0, 2.0, 1.0}) {
      const auto n = static_cast<int>(all.points.size());
      const auto ball = testing::icosphere(1);
      for (const auto p : ball.points) all.points.push_back(radius * p);
      const bool turned = (radius == 2 && middle_turned) || (radius == 1 && core_turned);
      for (const auto& [a, b, c] : ball.triangles)
        all.triangles.push_back(turned ? std::array{a + n, c + n, b + n} : std::array{a + n, b + n, c + n});
    }
    return describe(all);
  };

  const auto sound = nested(true, false);

  EXPECT_TRUE(sound.is_body());
  EXPECT_EQ(sound.turned_shells.count, 0);
  ASSERT_EQ(sound.shells.size(), 3U);
  EXPECT_EQ(sound.shells[1].depth, 1);
  EXPECT_EQ(sound.shells[2].depth, 2);
  for (const auto& [middle, core, n_wrong] : {std::tuple(false, false, 1), {true, true, 1}, {false, true, 2}}) {
    const auto wrong = nested(middle, core);
    EXPECT_FALSE(wrong.is_body());
    EXPECT_EQ(wrong.turned_shells.count, n_wrong);
    EXPECT_EQ(faults_of(wrong).size(), 1U);
  }
}

TEST(Describe, TakesNothing) { EXPECT_EQ(faults_of(describe({})), std::vector<std::string>{"no triangles"}); }

}  // namespace describe_test
}  // namespace pamr::surface_mesh
