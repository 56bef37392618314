// SPDX-License-Identifier: GPL-3.0-or-later
/// Properties that every kind of surface must have, on random points.
#include "pamr/geometry/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "pamr/geometry/cone.hpp"
#include "pamr/geometry/cylinder.hpp"
#include "pamr/geometry/plane.hpp"
#include "pamr/geometry/polynomial.hpp"
#include "pamr/geometry/quadric.hpp"
#include "pamr/geometry/revolution.hpp"
#include "pamr/geometry/sphere.hpp"
#include "pamr/geometry/torus.hpp"

namespace pamr::geometry {
namespace surface_test {

constexpr double pi = std::numbers::pi;

/// A surface and a way to walk over all of it near the sample box: two parameters in [0, 1].
struct Kind {
  std::string name;
  std::function<std::unique_ptr<const Surface>()> make;
  std::function<Vec3(double, double)> sample;
};

void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

const Vec3 center{0.3, -0.2, 0.1};
const Vec3 axis{2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0};
const Vec3 side_a{3.0 / std::sqrt(13.0), -2.0 / std::sqrt(13.0), 0};
const Vec3 side_b = cross(axis, side_a);

Vec3 turned(double x, double r, double turn) {
  return center + x * axis + r * std::cos(2 * pi * turn) * side_a + r * std::sin(2 * pi * turn) * side_b;
}

/// A blunt cone: nose arc of radius 0.5, tangent cone of 30 degrees, tangent shoulder arc of radius 0.2 up to the
/// greatest x, base line to the axis. x from 0.
struct BluntCone {
  double angle = pi / 6, nose = 0.5, shoulder = 0.2, length = 1.0;
  Meridian tip{0, 0}, nose_center{nose, 0};
  Meridian cone_start{nose - nose * std::sin(angle), nose* std::cos(angle)};
  Meridian cone_end = cone_start + length * Meridian{std::cos(angle), std::sin(angle)};
  Meridian shoulder_center = cone_end + shoulder * Meridian{std::sin(angle), -std::cos(angle)};
  Meridian base_top = shoulder_center + Meridian{shoulder, 0};
  std::vector<ProfilePiece> profile = {{tip, cone_start, ProfileArc{nose_center, true}},
                                       {cone_start, cone_end, {}},
                                       {cone_end, base_top, ProfileArc{shoulder_center, true}},
                                       {base_top, {base_top.x, 0}, {}}};
  Meridian at(double s) const {
    const double t = 4 * s - std::floor(std::min(4 * s, 3.0));
    if (4 * s < 1)
      return nose_center + nose * Meridian{-std::cos(t * (pi / 2 - angle)), std::sin(t * (pi / 2 - angle))};
    if (4 * s < 2) return cone_start + t * (cone_end - cone_start);
    if (4 * s < 3) {
      const double from_axis = (pi / 2 + angle) * (1 - t);
      return shoulder_center + shoulder * Meridian{std::cos(from_axis), std::sin(from_axis)};
    }
    return base_top + t * (Meridian{base_top.x, 0} - base_top);
  }
};

/// sum(square y^2 + linear y) + constant in the turned frame of (side_a, side_b, axis) about `center`, written out in
/// x, y, z.
std::unique_ptr<const Surface> turned_quadric(Vec3 square, Vec3 linear, double constant) {
  std::array<double, 10> c{};
  c[9] = constant;
  const std::array<Vec3, 3> direction{side_a, side_b, axis};
  const std::array<double, 3> squares{square.x, square.y, square.z}, linears{linear.x, linear.y, linear.z};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 d = direction[i];
    const double s = squares[i], l = linears[i], at = dot(d, center);  // s (d x - at)^2 + l (d x - at)
    const std::array<double, 10> term{
        s * d.x * d.x,     s * d.y * d.y,          s * d.z * d.z,          2 * s * d.x * d.y,      2 * s * d.y * d.z,
        2 * s * d.z * d.x, (l - 2 * s * at) * d.x, (l - 2 * s * at) * d.y, (l - 2 * s * at) * d.z, (s * at - l) * at};
    for (std::size_t k = 0; k < 10; ++k) c[k] += term[k];
  }
  return std::make_unique<Quadric>(c);
}

Vec3 in_frame(double a, double b, double c) { return center + a * side_a + b * side_b + c * axis; }

/// A saddle over a square, cut into 2 x 2 segments.
std::unique_ptr<const Surface> saddle_in_segments() {
  PolynomialSegment all;
  all.coefficient = {center, side_a, side_b, 0.3 * axis, 0.1 * axis, -0.2 * axis};
  std::vector<PolynomialSegment> segments;
  for (const double u : {-3.0, 0.0})
    for (const double v : {-3.0, 0.0}) {
      segments.push_back(all);
      segments.back().u = {u, u + 3};
      segments.back().v = {v, v + 3};
    }
  return std::make_unique<Polynomial>(segments);
}

std::vector<Kind> all_kinds() {
  return {
      {"Plane", [] { return std::make_unique<Plane>(center, 5.0 * axis); },
       [](double s, double t) { return center + (6 * s - 3) * side_a + (6 * t - 3) * side_b; }},
      {"Sphere", [] { return std::make_unique<Sphere>(center, 0.7); },
       [](double s, double t) { return turned(-0.7 * std::cos(pi * s), 0.7 * std::sin(pi * s), t); }},
      {"Cylinder", [] { return std::make_unique<Cylinder>(center, -2.0 * axis, 0.6); },
       [](double s, double t) { return turned(8 * s - 4, 0.6, t); }},
      {"Cone", [] { return std::make_unique<Cone>(center, axis, 35.0); },
       [](double s, double t) { return turned(5 * s * std::cos(35 * pi / 180), 5 * s * std::sin(35 * pi / 180), t); }},
      {"Torus", [] { return std::make_unique<Torus>(center, axis, 0.9, 0.35); },
       [](double s, double t) { return turned(0.35 * std::cos(2 * pi * s), 0.9 + 0.35 * std::sin(2 * pi * s), t); }},
      {"BluntCone", [] { return std::make_unique<Revolution>(center, axis, BluntCone{}.profile); },
       [](double s, double t) {
         const Meridian m = BluntCone{}.at(s);
         return turned(m.x, m.r, t);
       }},
      {"Ellipsoid",
       [] {
         return turned_quadric({1 / 0.36, 1 / 0.25, 1 / 0.81}, {}, -1);
       },
       [](double s, double t) {
         return in_frame(0.6 * std::sin(pi * s) * std::cos(2 * pi * t), 0.5 * std::sin(pi * s) * std::sin(2 * pi * t),
                         0.9 * std::cos(pi * s));
       }},
      {"Hyperboloid",
       [] {
         return turned_quadric({1 / 0.36, 1 / 0.25, -1}, {}, -1);
       },
       [](double s, double t) {
         const double r = std::cosh(3 * s - 1.5);
         return in_frame(0.6 * r * std::cos(2 * pi * t), 0.5 * r * std::sin(2 * pi * t), std::sinh(3 * s - 1.5));
       }},
      {"Paraboloid",
       [] {
         return turned_quadric({0.5, 0.8, 0}, {0, 0, -1}, 0);
       },
       [](double s, double t) {
         const double a = 2.5 * s * std::cos(2 * pi * t), b = 2 * s * std::sin(2 * pi * t);
         return in_frame(a, b, 0.5 * a * a + 0.8 * b * b);
       }},
      {"EllipticCylinder",
       [] {
         return turned_quadric({1 / 0.36, 1 / 0.25, 0}, {}, -1);
       },
       [](double s, double t) { return in_frame(0.6 * std::cos(2 * pi * t), 0.5 * std::sin(2 * pi * t), 8 * s - 4); }},
      {"Saddle",
       [] {
         return turned_quadric({0.3, -0.2, 0}, {0, 0, -1}, 0);
       },
       [](double s, double t) {
         const double a = 6 * s - 3, b = 6 * t - 3;
         return in_frame(a, b, 0.3 * a * a - 0.2 * b * b);
       }},
      {"Segments", [] { return saddle_in_segments(); },
       [](double s, double t) {
         const double a = 6 * s - 3, b = 6 * t - 3;
         return in_frame(a, b, 0.3 * a * a + 0.1 * a * b - 0.2 * b * b);
       }},
  };
}

std::vector<Vec3> random_points(std::size_t count, std::uint64_t seed, double half_width) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-half_width, half_width);
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = {unit(random), unit(random), unit(random)};
  return points;
}

class EverySurface : public testing::TestWithParam<Kind> {};

TEST_P(EverySurface, KeepsItsOwnPoints) {
  const auto surface = GetParam().make();
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3 p = GetParam().sample(unit(random), unit(random));

    ASSERT_LT(surface->distance(p), 5e-15);
    ASSERT_LT(norm(surface->project(p) - p), 5e-15);
  }
}

TEST_P(EverySurface, ProjectsAProjectedPointOntoItself) {
  const auto surface = GetParam().make();
  for (const Vec3 p : random_points(5000, 2, 2.0)) {
    const Vec3 once = surface->project(p), twice = surface->project(once);

    ASSERT_LT(norm(twice - once), 1e-14 * norm(once)) << p.x << ' ' << p.y << ' ' << p.z;
    ASSERT_LT(surface->distance(once), 1e-14);
    ASSERT_NEAR(surface->distance(p), norm(p - once), 1e-14);
  }
}

TEST_P(EverySurface, HasNoNearerPointInADenseSampling) {
  const auto surface = GetParam().make();
  constexpr int n = 200;
  std::vector<Vec3> samples;
  for (int i = 0; i <= n; ++i)
    for (int k = 0; k < n; ++k) samples.push_back(GetParam().sample(double(i) / n, double(k) / n));
  for (const Vec3 p : random_points(60, 3, 1.0)) {
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3 q : samples) least = std::min(least, norm(p - q));

    const double distance = surface->distance(p);
    ASSERT_LE(distance, least + 1e-14);
    // Samples are at most 0.04 apart: the nearest one cannot be farther than half a diagonal from the foot.
    ASSERT_GE(distance + 0.03, least);
  }
}

TEST_P(EverySurface, HasTheGradientOfItsDistanceAsNormal) {
  const auto surface = GetParam().make();
  int compared = 0;
  for (const Vec3 p : random_points(500, 4, 1.5)) {
    const double distance = surface->distance(p), step = 1e-5;
    if (distance < 10 * step) continue;
    const auto slope = [&](Vec3 d) {
      return (surface->distance(p + step * d) - surface->distance(p - step * d)) / (2 * step);
    };
    const Vec3 gradient{slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})};
    if (std::abs(norm(gradient) - 1) > 1e-6) continue;  // a fold of the distance runs between the six points

    const Vec3 normal = surface->normal(p);
    ASSERT_NEAR(norm(normal), 1, 1e-14);
    // At an edge or end of the surface the gradient points to the edge and may leave the normal.
    const Vec3 foot = surface->project(p);
    const double side = dot(p - foot, normal);
    if (std::abs(std::abs(side) - distance) > 1e-9) continue;
    ASSERT_LT(norm(std::copysign(1.0, side) * gradient - normal), 1e-6);
    ++compared;
  }
  EXPECT_GT(compared, 250);
}

TEST_P(EverySurface, HasANormalThatDoesNotJumpNearTheSurface) {
  const auto surface = GetParam().make();
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0.05, 0.7);  // short of the sharp edge between shoulder and base
  for (int trial = 0; trial < 2000; ++trial) {
    const double s = unit(random), t = unit(random), step = 1e-6;
    const Vec3 a = GetParam().sample(s, t), b = GetParam().sample(s + step, t);

    ASSERT_LT(norm(surface->normal(a) - surface->normal(b)), 100 * step);
    const Vec3 out = surface->normal(a);
    ASSERT_LT(norm(surface->normal(a + 1e-3 * out) - out), 1e-9);
    ASSERT_LT(norm(surface->normal(a - 1e-3 * out) - out), 1e-9);
  }
}

TEST_P(EverySurface, GivesTheSameBitsTwiceAndFinitePointsFromAnywhere) {
  const auto surface = GetParam().make(), other = GetParam().make();
  std::vector<Vec3> points = random_points(100, 6, 3.0);
  for (int i = -10; i <= 10; ++i) points.push_back(center + 0.2 * i * axis);
  points.push_back(center + Vec3{1e-160, 0, 0});
  points.push_back({1e10, -1e10, 1e10});
  for (const Vec3 p : points) {
    const Vec3 q = surface->project(p), n = surface->normal(p);

    ASSERT_EQ(q, other->project(p));
    ASSERT_EQ(n, other->normal(p));
    ASSERT_TRUE(std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z));
    ASSERT_NEAR(norm(n), 1, 1e-14);
    ASSERT_LT(surface->distance(q), 1e-14 * std::max(1.0, norm(q)));
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EverySurface, testing::ValuesIn(all_kinds()),
                         [](const auto& parameter) { return parameter.param.name; });

TEST(Plane, IsExactOnACoordinatePlane) {
  const Plane plane({0.1, 0, 0}, {3, 0, 0});

  EXPECT_EQ(plane.project({1e6 / 3, 0.7, -0.3}), (Vec3{0.1, 0.7, -0.3}));
  EXPECT_EQ(plane.normal({5, 6, 7}), (Vec3{1, 0, 0}));
  EXPECT_TRUE(plane.is_flat());
}

TEST(Sphere, ProjectsItsCenterTowardsX) {
  const Sphere sphere({1, 2, 3}, 2);

  EXPECT_EQ(sphere.project({1, 2, 3}), (Vec3{3, 2, 3}));
  EXPECT_EQ(sphere.normal({1, 2, 3}), (Vec3{1, 0, 0}));
  EXPECT_EQ(sphere.distance({1, 2, 3}), 2);
  EXPECT_FALSE(sphere.is_flat());
}

TEST(Cone, HasOneNappe) {
  const Cone cone({0, 0, 0}, {1, 0, 0}, 45);

  EXPECT_LT(norm(cone.project({2, 0, 0}) - (Vec3{1, 0, 1})), 1.5) << "on the axis: a fixed side";
  EXPECT_NEAR(cone.distance({2, 0, 0}), std::sqrt(2.0), 1e-15);
  EXPECT_EQ(cone.project({-2, 0.5, 0}), (Vec3{0, 0, 0}));
}

TEST(Quadric, IsTheSphereWhereItsCoefficientsAre) {
  const Quadric ball({1, 1, 1, 0, 0, 0, -2, 0, 0, -3});  // (x - 1)^2 + y^2 + z^2 = 4
  const Sphere sphere({1, 0, 0}, 2);

  for (const Vec3 p : random_points(500, 7, 4.0)) EXPECT_LT(norm(ball.project(p) - sphere.project(p)), 2e-15);
  EXPECT_EQ(ball.project({1, 0, 0}), (Vec3{3, 0, 0})) << "its center, like that of a sphere";
}

TEST(Quadric, FindsTheNearestOfManyCriticalPointsFromInside) {
  // on the long axis of an ellipsoid, within the focal segment: two nearest points, off the axis
  const Quadric cigar({1.0 / 9, 1, 1, 0, 0, 0, 0, 0, 0, -1});

  const Vec3 foot = cigar.project({1, 0, 0});

  // y^2 + z^2 = 1 - x^2 / 9 with x = (1 + 1 / 8) from the stationarity of the distance
  EXPECT_NEAR(foot.x, 1.125, 1e-15);
  EXPECT_NEAR(std::hypot(foot.y, foot.z), std::sqrt(1 - 1.125 * 1.125 / 9), 1e-15);
}

TEST(Quadric, GivesTheTipOfAConeAndANormalThere) {
  const Quadric cone({1, 1, -1, 0, 0, 0, 0, 0, 0, 0});

  EXPECT_NEAR(cone.distance({0, 0, 2}), std::sqrt(2.0), 1e-15);
  EXPECT_EQ(cone.project({0, 0, 0}), (Vec3{0, 0, 0}));
  EXPECT_NEAR(norm(cone.normal({0, 0, 0})), 1, 1e-15);
}

TEST(Polynomial, EndsWhereItsParametersEnd) {
  PolynomialSegment square;
  square.coefficient = {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{}, Vec3{}, Vec3{}};
  const Polynomial surface({square});

  EXPECT_EQ(surface.project({2, 0.25, 3}), (Vec3{1, 0.25, 0}));
  EXPECT_EQ(surface.project({-2, 7, 3}), (Vec3{0, 1, 0}));
  EXPECT_EQ(surface.project_to_seam({0.5, 0.75, 0}), (Vec3{0.5, 1, 0}));
  EXPECT_EQ(surface.normal({0.5, 0.5, -2}), (Vec3{0, 0, 1}));
}

TEST(Polynomial, HasANormalAtAPole) {
  PolynomialSegment dish;  // a disc in polar-like parameters: u v, a corner where v does not matter
  dish.coefficient = {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{}, Vec3{}, Vec3{0, 1, 0}, Vec3{}};
  const Polynomial surface({dish});

  EXPECT_EQ(surface.project({-1, 0, 0.5}), (Vec3{0, 0, 0}));
  EXPECT_LT(norm(surface.normal({-1, 0, 0.5}) - Vec3{0, 0, 1}), 1e-15);
}

TEST(Surfaces, KeepPointsOfASymmetryPlaneInItExactly) {
  const Revolution body({0, 0, 0}, {1, 0, 0}, BluntCone{}.profile);
  const Cylinder tube({0, 0, 0}, {1, 0, 0}, 0.3);
  for (const Vec3 p : random_points(200, 8, 2.0)) {
    EXPECT_EQ(body.project({p.x, 0, p.z}).y, 0);
    EXPECT_EQ(tube.project({p.x, 0, p.z}).y, 0);
  }
}

}  // namespace surface_test
}  // namespace pamr::geometry
