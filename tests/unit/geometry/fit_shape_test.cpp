// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/fit_shape.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "pamr/geometry/described_surface.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/surface_toml.hpp"

namespace pamr::geometry {
namespace fit_shape_test {

constexpr double pi = std::numbers::pi;

struct Cloud {
  std::vector<Vec3> point, normal;
};

/// Points of a described surface over a range of its two parameters, with normals that are off by up to `error`, as
/// those of faces are.
struct Range {
  double u0, u1, v0, v1;
};
template <class Place>
Cloud sample(Place place, Range range, double error = 0.05, int n = 200) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  Cloud cloud;
  for (int i = 0; i < n; ++i) {
    const double u = range.u0 + (range.u1 - range.u0) * unit(random),
                 v = range.v0 + (range.v1 - range.v0) * unit(random);
    const auto [p, normal] = place(u, v);
    const Vec3 off{unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5};
    const Vec3 tilted = normal + 2 * error * off;
    cloud.point.push_back(p);
    cloud.normal.push_back((1 / norm(tilted)) * tilted);
  }
  return cloud;
}

/// A frame that no coordinate axis is near to.
const Vec3 axis = (1 / std::sqrt(14.0)) * Vec3{1, 2, 3}, e1 = (1 / std::sqrt(5.0)) * Vec3{2, -1, 0},
           e2 = cross(axis, e1);
const Vec3 place{3, -2, 5};

using Placed = std::pair<Vec3, Vec3>;
Vec3 around(double angle) { return std::cos(angle) * e1 + std::sin(angle) * e2; }
Placed on_cylinder(double angle, double z) { return {place + z * axis + 0.7 * around(angle), around(angle)}; }
Placed on_cone(double angle, double z) {
  return {place + z * axis + (0.5 * z) * around(angle), (1 / std::sqrt(1.25)) * (around(angle) - 0.5 * axis)};
}
Placed on_torus(double angle, double of_tube) {
  const Vec3 out = std::cos(of_tube) * around(angle) + std::sin(of_tube) * axis;
  return {place + 2.0 * around(angle) + 0.6 * out, out};
}
Placed on_sphere(double angle, double polar) {
  const Vec3 out = std::sin(polar) * around(angle) + std::cos(polar) * axis;
  return {place + 1.5 * out, out};
}

std::vector<ShapeKind> kinds_that_fit(const Cloud& cloud) {
  std::vector<ShapeKind> kinds;
  for (const auto kind : shape_kinds)
    if (fit_shape(kind, cloud.point, cloud.normal)) kinds.push_back(kind);
  return kinds;
}

TEST(FitShape, FindsWholeAndPartialShapesInAnyPositionAndNoOthers) {
  using Kind = ShapeKind;
  const std::vector<std::pair<Kind, Cloud>> clouds{
      {Kind::sphere, sample(on_sphere, {0, 2 * pi, 0, pi})}, {Kind::sphere, sample(on_sphere, {0, 2 * pi, 0, 0.4})},
      {Kind::sphere, sample(on_sphere, {0, 0.5, 1.0, 1.4})}, {Kind::cylinder, sample(on_cylinder, {0, 2 * pi, 0, 1})},
      {Kind::cylinder, sample(on_cylinder, {0, 0.6, 0, 1})}, {Kind::cylinder, sample(on_cylinder, {0, 0.6, 0, 10})},
      {Kind::cone, sample(on_cone, {0, 2 * pi, 0, 1})},      {Kind::cone, sample(on_cone, {0, 2 * pi, 3, 4})},
      {Kind::cone, sample(on_cone, {0, 0.8, 1, 2})},         {Kind::torus, sample(on_torus, {0, 2 * pi, 0, 2 * pi})},
      {Kind::torus, sample(on_torus, {0, 1.5, 0, 2 * pi})},  {Kind::torus, sample(on_torus, {0, 2 * pi, 0, pi / 2})},
      {Kind::torus, sample(on_torus, {0, 1, 2, 3})},
  };
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    const auto& [kind, cloud] = clouds[i];

    EXPECT_EQ(kinds_that_fit(cloud), std::vector{kind}) << i;

    const auto fit = fit_shape(kind, cloud.point, cloud.normal);
    ASSERT_TRUE(fit) << i;
    EXPECT_LT(fit->worst, 3e-14) << i;
    const double size = kind == Kind::sphere     ? 1.5
                        : kind == Kind::cylinder ? 0.7
                        : kind == Kind::cone     ? std::atan(0.5)
                                                 : 2;
    EXPECT_NEAR(fit->shape.radius, size, 3e-12) << i;
    if (kind == Kind::torus) {
      EXPECT_NEAR(fit->shape.of_tube, 0.6, 3e-12) << i;
    }
    if (kind != Kind::cylinder) {
      EXPECT_LT(norm(fit->shape.place - place), 3e-11) << i;
    }
    if (kind != Kind::sphere) {
      EXPECT_LT(norm(cross(fit->shape.axis, axis)), 3e-11) << i;
    }
    const auto described = described_shape("a \"b\"", fit->shape);
    const auto read = surfaces_from_toml(described.toml, "test");
    for (const auto& p : cloud.point) {
      EXPECT_LT(described.surface->distance(p), 3e-14) << i;
      EXPECT_EQ(described.surface->project(p), read.find("a \"b\"")->project(p)) << i;
    }
  }
}

TEST(FitShape, WritesShortNumbersWhereTheyFitAsWell) {
  std::vector<Vec3> point, normal;
  for (int i = 0; i < 24; ++i)
    for (int k = 0; k < 3; ++k) {
      const Vec3 out{std::cos(pi * i / 12), std::sin(pi * i / 12), 0};
      point.push_back(Vec3{0.1, 0.2, 0.3 * k} + 0.25 * out);
      normal.push_back(out);
    }

  const auto fit = fit_shape(ShapeKind::cylinder, point, normal);

  ASSERT_TRUE(fit);
  EXPECT_EQ(described_shape("pipe", fit->shape).toml,
            "[[surface]]\nname = \"pipe\"\nkind = \"cylinder\"\npoint = [0.1, 0.2, 0]\naxis = [0, 0, 1]\n"
            "radius = 0.25\n");
}

TEST(FitShape, NodesBesideTheShapeDoNotMoveIt) {
  auto cloud = sample(on_cylinder, {0, 4, 0, 1});
  for (std::size_t i = 0; i < 30; ++i) cloud.point[i] += (i % 2 == 0 ? 3e-7 : -1e-7) * cloud.normal[i];

  const auto fit = fit_shape(ShapeKind::cylinder, cloud.point, cloud.normal);

  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->shape.radius, 0.7, 1e-13) << "as if the thirty were not there";
  EXPECT_NEAR(fit->worst, 3e-7, 1e-8);
}

TEST(FitShape, RefusesWhatHasTooFewPointsIsFlatOrOnlyNearlyRight) {
  const auto ball = sample(on_sphere, {0, 2 * pi, 0, pi}, 0.05, 11);
  EXPECT_TRUE(kinds_that_fit(ball).empty()) << "eleven points for four unknowns";
  const auto dish = sample(on_sphere, {0, 2 * pi, 0, 0.0002});
  EXPECT_TRUE(kinds_that_fit(dish).empty()) << "as good as flat";
  auto egg = sample(on_sphere, {0, 2 * pi, 0, pi});
  for (auto& p : egg.point) p.x *= 1.0001;
  EXPECT_TRUE(kinds_that_fit(egg).empty());
  auto lost = sample(on_sphere, {0, 2 * pi, 0, pi});
  lost.point[3].y = std::nan("");
  EXPECT_TRUE(kinds_that_fit(lost).empty());
}

TEST(FitShape, TwoCirclesFitSeveralShapes) {
  std::vector<Vec3> point, normal;
  for (int i = 0; i < 24; ++i)
    for (const double z : {0.0, 0.5}) {
      const Vec3 out{std::cos(pi * i / 12), std::sin(pi * i / 12), 0};
      point.push_back(out + Vec3{0, 0, z});
      normal.push_back(out);
    }

  const auto kinds = kinds_that_fit({point, normal});

  EXPECT_THAT(kinds, testing::IsSupersetOf({ShapeKind::sphere, ShapeKind::cylinder}));
}

}  // namespace fit_shape_test
}  // namespace pamr::geometry
