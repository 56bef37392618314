// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/repair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "support/triangulations.hpp"
#include "surface_mesh/change_scale.hpp"

namespace pamr::surface_mesh {
namespace repair_test {

using geometry::Triangulation;

void add(Triangulation& to, const Triangulation& other, bool turned = false) {
  const auto n = static_cast<int>(to.points.size());
  to.points.insert(to.points.end(), other.points.begin(), other.points.end());
  for (const auto& [a, b, c] : other.triangles)
    to.triangles.push_back(turned ? std::array{a + n, c + n, b + n} : std::array{a + n, b + n, c + n});
}

Triangulation ball_at(geometry::Vec3 center, double radius, int levels) {
  auto ball = testing::icosphere(levels);
  scale(ball, radius);
  translate(ball, center);
  return ball;
}

TEST(Repair, LeavesASoundBodyToTheBit) {
  const auto ball = testing::icosphere(2);

  const auto done = repair(ball);

  EXPECT_EQ(done.surface, ball);
  EXPECT_FALSE(done.has_changed());
  EXPECT_TRUE(done.left.is_body());
}

TEST(Repair, WeldsPointsThatRoundingPartedAndCountsThem) {
  const auto ball = testing::icosphere(2);
  Triangulation apart;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-1e-9, 1e-9);
  for (const auto& corner : ball.triangles) {
    const auto n = static_cast<int>(apart.points.size());
    for (const int p : corner)
      apart.points.push_back(ball.points[static_cast<std::size_t>(p)] +
                             geometry::Vec3{noise(random), noise(random), noise(random)});
    apart.triangles.push_back({n, n + 1, n + 2});
  }

  const auto done = repair(apart);

  EXPECT_EQ(done.n_welded_points, std::ssize(apart.points) - std::ssize(ball.points));
  EXPECT_EQ(done.surface.points.size(), ball.points.size());
  EXPECT_TRUE(done.left.is_body());
}

TEST(Repair, TurnsTrianglesBackAndDropsDuplicates) {
  auto ball = testing::icosphere(2);
  for (const int t : {3, 50, 51, 200})
    std::swap(ball.triangles[static_cast<std::size_t>(t)][1], ball.triangles[static_cast<std::size_t>(t)][2]);
  ball.triangles.push_back(ball.triangles[7]);
  auto turned_copy = ball.triangles[8];
  std::swap(turned_copy[0], turned_copy[1]);
  ball.triangles.push_back(turned_copy);

  const auto done = repair(ball);

  EXPECT_EQ(done.oriented.n_turned, 4);
  EXPECT_EQ(done.n_duplicates, 2);
  EXPECT_EQ(done.surface.points, testing::icosphere(2).points);
  EXPECT_TRUE(done.left.is_body());
}

TEST(Repair, ClosesSmallHolesSmoothlyAndLeavesLargeOnes) {
  auto ball = testing::icosphere(4);
  const auto is_near = [&](int p, geometry::Vec3 pole, double size) {
    return norm(ball.points[static_cast<std::size_t>(p)] - pole) < size;
  };
  std::erase_if(ball.triangles, [&](const auto& t) {
    return is_near(t[0], {1, 0, 0}, 0.09) || is_near(t[0], {0, 0, -1}, 0.6);
  });

  const auto done = repair(ball, {.max_hole = 0.6});

  EXPECT_EQ(done.holes.n_holes, 1);
  EXPECT_EQ(done.holes.n_large, 1);
  EXPECT_EQ(done.left.loops.size(), 1U);
  ASSERT_EQ(faults_of(done.left).size(), 1U);
  // The cap of the small hole is 0.011 high; what fills it is round.
  for (const auto p : done.surface.points) EXPECT_TRUE(p.x < 0.9 || std::abs(norm(p) - 1) < 2e-3) << norm(p);
  const auto all = repair(ball, {.max_hole = 2});
  EXPECT_TRUE(all.left.is_body());
}

TEST(Repair, CutsFinsAndSmallOpenShellsOff) {
  auto ball = testing::icosphere(3);
  const auto edge = ball.triangles[100];
  ball.points.push_back(1.2 * ball.points[static_cast<std::size_t>(edge[0])]);
  ball.triangles.push_back({edge[0], edge[1], static_cast<int>(ball.points.size()) - 1});
  add(ball, {.name = {}, .points = {{3, 0, 0}, {3.1, 0, 0}, {3, 0.1, 0}}, .triangles = {{0, 1, 2}}});

  const auto done = repair(ball);

  EXPECT_EQ(done.oriented.n_cut_edges, 1);
  EXPECT_EQ(done.shells.n_shells, 2);
  EXPECT_EQ(done.shells.n_triangles, 2);
  EXPECT_TRUE(done.left.is_body());
  EXPECT_EQ(done.surface.triangles.size(), testing::icosphere(3).triangles.size());
}

TEST(Repair, TurnsShellsOutwardsAndCavitiesInwards) {
  auto body = ball_at({0, 0, 0}, 2, 2);
  for (auto& t : body.triangles) std::swap(t[1], t[2]);
  add(body, ball_at({0.2, 0, 0}, 1, 2));          // a cavity that is seen from the wrong side
  add(body, ball_at({0.2, 0, 0}, 0.5, 2), true);  // a core in it, likewise

  const auto done = repair(body);

  EXPECT_EQ(done.turned.n_outwards, 2);
  EXPECT_EQ(done.turned.n_inwards, 1);
  const double unit = describe(testing::icosphere(2), {.find_deviation = false}).volume;
  EXPECT_NEAR(done.left.volume, unit * (8 - 1 + 0.125), 1e-9);
  EXPECT_TRUE(done.left.is_body());
}

/// The box from one corner to the other, its first triangles at the side of least x.
Triangulation box(geometry::Vec3 low, geometry::Vec3 high) {
  Triangulation result{.name = {},
                       .points = {},
                       .triangles = {{0, 6, 2},
                                     {0, 4, 6},
                                     {1, 3, 7},
                                     {1, 7, 5},
                                     {0, 1, 5},
                                     {0, 5, 4},
                                     {2, 7, 3},
                                     {2, 6, 7},
                                     {0, 3, 1},
                                     {0, 2, 3},
                                     {4, 5, 7},
                                     {4, 7, 6}}};
  for (int i = 0; i < 8; ++i)
    result.points.push_back(
        {i % 2 == 0 ? low.x : high.x, i / 2 % 2 == 0 ? low.y : high.y, i / 4 == 0 ? low.z : high.z});
  return result;
}

TEST(Repair, LeavesShellsThatTouchOthersAsTheyAre) {
  const auto with = [](const Triangulation& other) {
    auto two = box({0, 0, 0}, {1, 1, 1});
    add(two, other);
    return two;
  };
  // Outside at a side, inside at a side, at an edge, across a side; the volumes are summed.
  for (const auto& other : {box({1, 0.25, 0.25}, {1.5, 0.75, 0.75}), box({0.5, 0.25, 0.25}, {1, 0.75, 0.75}),
                            box({1, 1, 0.25}, {1.5, 1.5, 0.75}), box({0.75, 0.25, 0.25}, {1.25, 0.75, 0.75})}) {
    const auto done = repair(with(other));

    EXPECT_EQ(done.turned.n_outwards + done.turned.n_inwards, 0);
    EXPECT_NEAR(done.left.volume, 1.125, 1e-15);
    EXPECT_EQ(done.left.shell_contacts.count, 1);
    EXPECT_FALSE(done.left.is_body());
  }
}

TEST(Repair, TakesTrianglesWithoutAreaOut) {
  auto ball = testing::icosphere(2);
  // A point on an edge, for one of its two triangles only: the other is made whole by a triangle without area.
  const auto [a, b, c] = ball.triangles[10];
  ball.points.push_back(midpoint(ball.points[static_cast<std::size_t>(a)], ball.points[static_cast<std::size_t>(b)]));
  const auto m = static_cast<int>(ball.points.size()) - 1;
  ball.triangles[10] = {a, m, c};
  ball.triangles.push_back({m, b, c});
  ball.triangles.push_back({a, b, m});

  const auto done = repair(ball);

  EXPECT_EQ(done.flat.n_flipped, 1);
  EXPECT_EQ(done.flat.n_left, 0);
  EXPECT_TRUE(done.left.is_body());
}

TEST(Repair, ResolvesTrianglesThatCutEachOther) {
  auto ball = testing::icosphere(4);
  // A spike goes through the ball and out on the other side.
  ball.points[700] = -1.1 * ball.points[700];
  ASSERT_GT(describe(ball, {.find_deviation = false}).self_intersections->count, 0);

  const auto done = repair(ball);

  EXPECT_GT(done.intersections.n_pairs, 0);
  EXPECT_EQ(done.intersections.n_pairs_left, 0);
  EXPECT_TRUE(done.left.is_body());
  const auto kept = repair(ball, {.resolve_intersections = false});
  EXPECT_FALSE(kept.left.is_body());
  EXPECT_EQ(kept.surface, ball);
}

TEST(Repair, MakesABodyOfAScanWithAllDefects) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    auto scan = testing::icosphere(4);
    std::mt19937 random(seed);
    const auto any = [&] { return random() % scan.triangles.size(); };
    for (int i = 0; i < 20; ++i) {
      auto& t = scan.triangles[any()];
      std::swap(t[0], t[1]);
    }
    for (int i = 0; i < 20; ++i) scan.triangles.push_back(scan.triangles[any()]);
    for (int i = 0; i < 10; ++i) scan.triangles.erase(scan.triangles.begin() + static_cast<std::ptrdiff_t>(any()));

    const auto done = repair(scan);

    EXPECT_TRUE(done.left.is_body()) << "seed " << seed;
    EXPECT_NEAR(done.left.volume, describe(testing::icosphere(4)).volume, 0.01) << "seed " << seed;
  }
}

TEST(Repair, TakesNothingAndRubbish) {
  EXPECT_FALSE(repair({}).left.is_body());
  EXPECT_FALSE(
      repair({.name = {}, .points = {{0, 0, 0}, {1, 0, 0}}, .triangles = {{0, 1, 1}, {0, 0, 0}}}).left.is_body());
}

}  // namespace repair_test
}  // namespace pamr::surface_mesh
