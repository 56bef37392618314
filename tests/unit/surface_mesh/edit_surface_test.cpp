// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pamr/base/error.hpp"
#include "support/triangulations.hpp"
#include "surface_mesh/change_scale.hpp"
#include "surface_mesh/describe.hpp"
#include "surface_mesh/remesh.hpp"
#include "surface_mesh/smooth_surface.hpp"
#include "surface_mesh/subdivide_surface.hpp"
#include "surface_mesh/surface_distance.hpp"

namespace pamr::surface_mesh {
namespace edit_surface_test {

double roughness(const geometry::Triangulation& ball) {
  double sum = 0;
  for (const auto p : ball.points) sum += (norm(p) - 1) * (norm(p) - 1);
  return std::sqrt(sum / static_cast<double>(ball.points.size()));
}

TEST(Smooth, TakesNoiseOffABall) {
  auto ball = testing::icosphere(4);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.005);
  for (auto& p : ball.points) p = (1 + noise(random)) * p;

  const auto done = smooth(ball, {.n_steps = 5});

  EXPECT_LT(roughness(done.surface), 0.5 * roughness(ball));
  EXPECT_NEAR(describe(done.surface).volume, describe(ball).volume, 3e-3);
  EXPECT_TRUE(describe(done.surface).is_body());
  EXPECT_EQ(done.surface.triangles, ball.triangles);
}

TEST(Smooth, LeavesSharpEdgesWhereTheyAre) {
  const auto cube = subdivide(testing::bored_cube(8), SubdivisionScheme::midpoint, 2);

  const auto done = smooth(cube, {.n_steps = 10});

  EXPECT_NEAR(describe(done.surface).volume, describe(cube).volume, 1e-9);
  EXPECT_GT(done.n_fixed, 0);
}

TEST(Subdivide, MakesFourOfEachTriangle) {
  const auto ball = testing::icosphere(2);
  const auto volume = describe(ball).volume;

  const auto same = subdivide(ball, SubdivisionScheme::midpoint, 1);
  const auto butterfly = subdivide(ball, SubdivisionScheme::butterfly, 1);
  const auto loop = subdivide(ball, SubdivisionScheme::loop, 1);

  for (const auto* result : {&same, &butterfly, &loop}) {
    EXPECT_EQ(result->triangles.size(), 4 * ball.triangles.size());
    EXPECT_TRUE(describe(*result).is_body());
  }
  EXPECT_NEAR(describe(same).volume, volume, 1e-12);
  EXPECT_GT(describe(butterfly).volume, volume);
  EXPECT_LT(describe(loop).volume, volume);
}

TEST(Remesh, MakesEvenTrianglesAndKeepsEdges) {
  const auto cube = testing::bored_cube(32);

  const auto done = remesh(cube, {.size = 0.2, .n_steps = 5});

  const auto d = describe(done.surface, {.find_deviation = false});
  EXPECT_TRUE(d.is_body());
  EXPECT_NEAR(d.mean_edge, 0.2, 0.05);
  EXPECT_GT(d.min_angle, 5);
  EXPECT_LT(distance_from_to(done.surface, cube).at_least, 0.03);
  EXPECT_LT(distance_from_to(cube, done.surface).at_least, 0.03);
}

TEST(ChangeScale, KnowsUnits) {
  auto ball = testing::icosphere(0);
  scale(ball, meters_of("mm"));
  EXPECT_NEAR(norm(ball.points[0]), 1e-3, 1e-18);
  EXPECT_EQ(meters_of("in"), 0.0254);
  EXPECT_THROW(meters_of("furlong"), Error);
  EXPECT_THROW(translate(ball, {0, std::nan(""), 0}), Error);
}

}  // namespace edit_surface_test
}  // namespace pamr::surface_mesh
