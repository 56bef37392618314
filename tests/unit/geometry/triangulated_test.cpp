// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "pamr/base/error.hpp"
#include "support/triangulations.hpp"

namespace pamr::geometry {
namespace {

/// Calls `use` with points all over each triangle.
void for_points_of(const Triangulation& s, const std::function<void(Vec3)>& use) {
  constexpr int n = 8;
  for (const auto& [a, b, c] : s.triangles)
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
        use((1 - u - v) * s.points[static_cast<std::size_t>(a)] + u * s.points[static_cast<std::size_t>(b)] +
            v * s.points[static_cast<std::size_t>(c)]);
      }
}

double distance_from_ball(Vec3 p) { return std::abs(norm(p) - 1); }

TEST(Triangulated, OfACoarseSphereIsFiftyTimesNearerToTheSphereThanItsTriangles) {
  const auto triangles = testing::icosphere(2);
  const Triangulated surface(triangles, {});

  double flat = 0, curved = 0, normals = 0;
  for_points_of(triangles, [&](Vec3 p) {
    const Vec3 q = surface.project(p);
    flat = std::max(flat, distance_from_ball(p));
    curved = std::max(curved, distance_from_ball(q));
    normals = std::max(normals, norm(surface.normal(q) - (1 / norm(q)) * q));
  });

  EXPECT_EQ(triangles.triangles.size(), 320U);
  EXPECT_EQ(surface.n_creases(), 0U);
  EXPECT_GT(flat / curved, 50);
  EXPECT_LT(normals, 0.005);
}

TEST(Triangulated, ProjectsPointsOfItselfOntoThemselves) {
  const auto triangles = testing::icosphere(1);
  const Triangulated surface(triangles, {});

  double worst = 0;
  for_points_of(triangles, [&](Vec3 p) {
    const Vec3 q = surface.project(p);
    worst = std::max(worst, norm(surface.project(q) - q));
  });

  EXPECT_LT(worst, 1e-15);
}

TEST(Triangulated, GivesThePointThatIsNearestAmongManyPointsOfTheSurface) {
  const auto triangles = testing::icosphere(1);
  const Triangulated surface(triangles, {});
  std::vector<Vec3> samples;
  for_points_of(triangles, [&](Vec3 p) { samples.push_back(surface.project(p)); });

  for (const Vec3 p : {Vec3{1.3, 0.2, 0.4}, {0.5, -0.6, 0.55}, {-0.2, 0.1, -2}, {0.6, 0.6, -0.5}}) {
    double least = 1e300;
    for (const Vec3 q : samples) least = std::min(least, norm(p - q));
    EXPECT_LE(surface.distance(p), least);
  }
}

TEST(Triangulated, KeepsPlanesOfABoredCubePlanarAndItsEdgesSharp) {
  const auto triangles = testing::bored_cube(24);
  const Triangulated surface(triangles, {});

  EXPECT_EQ(surface.n_patches(), 7U);
  EXPECT_EQ(surface.project({0.9, 0.3, 1.01}), (Vec3{0.9, 0.3, 1}));
  EXPECT_EQ(surface.project({0.7, 0.03, 0.99}), (Vec3{0.7, 0.03, 1}));
  EXPECT_EQ(surface.project({-1.5, 0.25, 0.3}), (Vec3{-1, 0.25, 0.3}));
  EXPECT_EQ(surface.normal({0.2, -0.9, -1.2}), (Vec3{0, 0, -1}));
  EXPECT_LT(norm(surface.project_to_seam({0.97, 1.02, 0.3}) - Vec3{1, 1, 0.3}), 1e-15);
}

TEST(Triangulated, RoundsTheBoreAndItsRims) {
  const auto triangles = testing::bored_cube(24);
  const Triangulated surface(triangles, {});

  double facets = 0, wall = 0, rim = 0, off_plane = 0, tilt = 0;
  for (int i = 0; i < 240; ++i) {
    const double angle = 2 * M_PI * i / 240;
    const Vec3 out{std::cos(angle), std::sin(angle), 0};
    for (const double z : {-0.8, 0.0, 0.35}) {
      const Vec3 q = surface.project(0.497 * out + Vec3{0, 0, z});
      wall = std::max(wall, std::abs(std::hypot(q.x, q.y) - 0.5));
      tilt = std::max(tilt, norm(surface.normal(q) + out));
    }
    const Vec3 q = surface.project_to_seam(0.49 * out + Vec3{0, 0, 1});
    rim = std::max(rim, std::abs(std::hypot(q.x, q.y) - 0.5));
    off_plane = std::max(off_plane, std::abs(q.z - 1));
  }
  facets = 0.5 * (1 - std::cos(M_PI / 24));

  EXPECT_LT(wall, facets / 20);
  EXPECT_LT(rim, facets / 1000);
  EXPECT_LT(off_plane, 1e-15);
  EXPECT_LT(tilt, 0.02);
}

TEST(Triangulated, CanBeOnePieceBetweenCreases) {
  const auto triangles = testing::bored_cube(24);
  Triangulated::Options options;
  options.near = Vec3{0.9, 0.9, 1};
  const Triangulated top(triangles, options);
  options.near = Vec3{0.5, 0, 0};
  const Triangulated bore(triangles, options);

  EXPECT_TRUE(top.is_flat());
  EXPECT_FALSE(bore.is_flat());
  EXPECT_EQ(top.project({0.9, 0.9, -3}), (Vec3{0.9, 0.9, 1}));
  EXPECT_NEAR(bore.distance({1, 0, 0}), 0.5, 3e-4);
  const std::array<const Surface*, 2> both{&top, &bore};
  const auto corner = project_onto_all(both, {0.49, 0.01, 1});
  EXPECT_TRUE(corner.converged);
  EXPECT_EQ(corner.point.z, 1);
  EXPECT_NEAR(std::hypot(corner.point.x, corner.point.y), 0.5, 1e-5);
}

TEST(Triangulated, RefusesOptionsOutOfRange) {
  Triangulated::Options options;
  options.feature_angle = 180;
  EXPECT_THROW(Triangulated(testing::icosphere(0), options), Error);
  options.feature_angle = 40;
  options.near = Vec3{0, 0, std::nan("")};
  EXPECT_THROW(Triangulated(testing::icosphere(0), options), Error);
}

}  // namespace
}  // namespace pamr::geometry
