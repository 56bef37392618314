// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/decimate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "pamr/geometry/triangulated/check_triangulation.hpp"
#include "support/triangulations.hpp"
#include "surface_mesh/change_scale.hpp"
#include "surface_mesh/describe.hpp"
#include "surface_mesh/subdivide_surface.hpp"

namespace pamr::surface_mesh {
namespace {

TEST(Decimate, KeepsTheErrorOnBothSides) {
  const auto ball = testing::icosphere(4);

  const auto done = decimate(ball, {.error = 0.01});

  EXPECT_TRUE(done.is_within);
  EXPECT_LE(done.from_old.at_least, 0.01);
  EXPECT_LE(done.to_old.at_least, 0.01);
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
        EXPECT_EQ(std::count(done.surface.points.begin(), done.surface.points.end(), geometry::Vec3{x, y, z}), 1);
  EXPECT_TRUE(done.is_within);
  EXPECT_TRUE(describe(done.surface).is_body());
}

TEST(Decimate, LeavesTheEndsOfAnOpenSurfaceWithoutAnError) {
  auto bowl = testing::icosphere(3);
  std::erase_if(bowl.triangles, [&](const auto& t) { return bowl.points[static_cast<std::size_t>(t[0])].z > 0.3; });
  geometry::drop_unused_points(bowl);
  const auto before = describe(bowl);

  const auto done = decimate(bowl, {.n_triangles = 200});

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

}  // namespace
}  // namespace pamr::surface_mesh
