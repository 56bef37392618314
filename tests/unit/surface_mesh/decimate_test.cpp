// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/decimate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/triangulated/check_triangulation.hpp"
#include "support/triangulations.hpp"
#include "surface_mesh/change_scale.hpp"
#include "surface_mesh/describe.hpp"
#include "surface_mesh/subdivide_surface.hpp"

namespace pamr::surface_mesh {
namespace decimate_test {

using geometry::Triangulation;
using geometry::Vec3;

double distance_to_segment(Vec3 p, Vec3 a, Vec3 b) {
  const double along = std::clamp(dot(p - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
  return norm(p - a - along * (b - a));
}

/// By the plane if the point is above the triangle, else by the sides.
double distance_to_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 normal = cross(b - a, c - a);
  if (dot(cross(b - a, p - a), normal) >= 0 && dot(cross(c - b, p - b), normal) >= 0 &&
      dot(cross(a - c, p - c), normal) >= 0)
    return std::abs(dot(p - a, normal)) / norm(normal);
  return std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

/// Largest distance of samples of the triangles of `from` to the triangles of `to`, each with each.
double sampled_distance(const Triangulation& from, const Triangulation& to) {
  constexpr int n = 5;
  double worst = 0;
  for (const auto& [a, b, c] : from.triangles)
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const Vec3 o = from.points[at(a)];
        const Vec3 p = o + (1.0 * i / n) * (from.points[at(b)] - o) + (1.0 * j / n) * (from.points[at(c)] - o);
        double nearest = std::numeric_limits<double>::infinity();
        for (const auto& [d, e, f] : to.triangles)
          nearest = std::min(nearest, distance_to_triangle(p, to.points[at(d)], to.points[at(e)], to.points[at(f)]));
        worst = std::max(worst, nearest);
      }
  return worst;
}

Triangulation with_noise(Triangulation surface, double width, std::mt19937& random) {
  std::normal_distribution<double> noise;  // of width 1: 0 is none that it may have
  for (auto& p : surface.points) p = p + Vec3{width * noise(random), width * noise(random), width * noise(random)};
  return surface;
}

/// A body with a wavy wall of even thickness, split `n` times.
Triangulation wavy_plate(double thickness, int n) {
  auto plate = subdivide(testing::bored_cube(8), SubdivisionScheme::midpoint, n);
  for (auto& p : plate.points) p = {p.x, p.y, 0.5 * thickness * p.z + 0.2 * std::sin(4 * p.x) * std::cos(3 * p.y + 1)};
  return plate;
}

Triangulation bowl(int levels) {
  auto surface = testing::icosphere(levels);
  std::erase_if(surface.triangles, [&](const auto& t) { return surface.points[at(t[0])].z > 0.3; });
  geometry::drop_unused_points(surface);
  return surface;
}

TEST(Decimate, NeverExceedsTheErrorAndKeepsBodies) {
  std::mt19937 random(7);
  std::vector<Triangulation> surfaces;
  for (const double width : {0.0, 0.003, 0.02}) {
    surfaces.push_back(with_noise(testing::icosphere(2), width, random));
    surfaces.push_back(with_noise(subdivide(testing::bored_cube(8), SubdivisionScheme::midpoint, 1), width, random));
    surfaces.push_back(with_noise(bowl(2), width, random));
    surfaces.push_back(with_noise(wavy_plate(0.1, 1), 0.3 * width, random));
  }
  surfaces.push_back(wavy_plate(0.02, 1));
  std::uniform_real_distribution<double> exponent(-4, -0.4);
  int n_bodies = 0, n_fewer = 0;
  for (const auto& surface : surfaces) {
    const auto before = describe(surface, {.find_deviation = false});
    for (int trial = 0; trial < 3; ++trial) {
      const double error = std::pow(10, exponent(random));

      const auto done = decimate(surface, {.error = error});

      EXPECT_LE(done.from_old.at_most, error);
      EXPECT_LE(done.to_old.at_most, error);
      EXPECT_LE(sampled_distance(surface, done.surface), error * (1 + 1e-12));
      EXPECT_LE(sampled_distance(done.surface, surface), error * (1 + 1e-12));
      const auto after = describe(done.surface, {.find_deviation = false});
      EXPECT_TRUE(after.is_surface());
      EXPECT_EQ(after.is_body(), before.is_body()) << error;
      n_bodies += before.is_body() ? 1 : 0;
      n_fewer += after.n_triangles < before.n_triangles ? 1 : 0;
    }
  }
  EXPECT_GE(n_bodies, 27);
  EXPECT_GE(n_fewer, 15);
}

TEST(Decimate, DoesNotMakeThinWallsCutThemselves) {
  const auto plate = wavy_plate(0.02, 2);

  const auto done = decimate(plate, {.n_triangles = 100});

  EXPECT_TRUE(describe(done.surface).is_body());
  EXPECT_GT(done.n_fixed, 0);
  EXPECT_LT(done.surface.triangles.size(), plate.triangles.size());
}

TEST(Decimate, DoesNotTurnABodyInsideOutThatIsSmallBesideTheError) {
  const auto ball = testing::icosphere(1);
  int n_bodies = 0;
  for (std::size_t n = 0; n < ball.points.size(); ++n) {
    auto spike = ball;
    spike.points[n].y = 255;
    if (!describe(spike, {.find_deviation = false}).is_body()) continue;
    ++n_bodies;

    const auto done = decimate(spike, {.error = 5.12});

    EXPECT_TRUE(describe(done.surface, {.find_deviation = false}).is_body()) << n;
  }
  EXPECT_GT(n_bodies, 3);
}

TEST(Decimate, GivesBackWhatNoErrorAllows) {
  const auto ball = testing::icosphere(2);

  const auto done = decimate(ball, {.error = 1e-300});

  EXPECT_EQ(done.surface.triangles.size(), ball.triangles.size());
  EXPECT_EQ(done.from_old.at_most, 0);
}

TEST(Decimate, KeepsTheErrorOnBothSides) {
  const auto ball = testing::icosphere(4);

  const auto done = decimate(ball, {.error = 0.01});

  EXPECT_LE(done.from_old.at_most, 0.01);
  EXPECT_LE(done.to_old.at_most, 0.01);
  EXPECT_LT(done.surface.triangles.size(), ball.triangles.size() / 4);
  EXPECT_NO_THROW(geometry::require_valid(done.surface, "decimated", false));
}

TEST(Decimate, ReachesTheNumberOfTriangles) {
  const auto done = decimate(testing::icosphere(4), {.n_triangles = 500});

  EXPECT_LE(done.surface.triangles.size(), 500U);
  EXPECT_GE(done.surface.triangles.size(), 498U);
  EXPECT_TRUE(describe(done.surface).is_body());
}

TEST(Decimate, KeepsPointsToTheBit) {
  auto ball = testing::icosphere(3);
  scale(ball, 1.0 / 3);
  translate(ball, {1e3, 0.1, -7});
  std::set<std::array<double, 3>> old;
  for (const auto p : ball.points) old.insert({p.x, p.y, p.z});

  const auto done = decimate(ball, {.n_triangles = 300});

  for (const auto p : done.surface.points) EXPECT_TRUE(old.contains({p.x, p.y, p.z}));
}

TEST(Decimate, TakesFlatSidesBackToTheirEdges) {
  const auto cube = testing::bored_cube(16);
  const auto fine = subdivide(cube, SubdivisionScheme::midpoint, 3);

  const auto done = decimate(fine, {.error = 1e-6});

  const auto d = describe(done.surface, {.find_deviation = false});
  EXPECT_LE(done.surface.triangles.size(), 4 * cube.triangles.size());
  EXPECT_NEAR(d.volume, describe(cube, {.find_deviation = false}).volume, 1e-9);
  EXPECT_TRUE(d.is_body());
}

TEST(Decimate, KeepsSharpEdgesOnTheirLines) {
  const auto fine = subdivide(testing::bored_cube(32), SubdivisionScheme::midpoint, 2);

  const auto done = decimate(fine, {.error = 0.02});

  // The corners of the cube are there, and no point of its edges has left them.
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0})
        EXPECT_EQ(std::count(done.surface.points.begin(), done.surface.points.end(), Vec3{x, y, z}), 1);
  EXPECT_LE(done.to_old.at_most, 0.02);
  EXPECT_TRUE(describe(done.surface).is_body());
}

TEST(Decimate, LeavesTheEndsOfAnOpenSurfaceWithoutAnError) {
  const auto open = bowl(3);
  const auto before = describe(open);

  const auto done = decimate(open, {.n_triangles = 200});

  const auto after = describe(done.surface);
  EXPECT_EQ(after.open_edges.count, before.open_edges.count);
  EXPECT_EQ(after.loops.size(), 1U);
  EXPECT_DOUBLE_EQ(after.loops[0].length, before.loops[0].length);
}

TEST(Decimate, DoesNotDependOnTheUnit) {
  auto ball = testing::icosphere(3);
  const auto meters = decimate(ball, {.error = 0.0625});
  scale(ball, 0x1p-30);
  const auto small = decimate(ball, {.error = 0x1p-34});

  EXPECT_EQ(small.surface.triangles, meters.surface.triangles);
}

}  // namespace decimate_test
}  // namespace pamr::surface_mesh
