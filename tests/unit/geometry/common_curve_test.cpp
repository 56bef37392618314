// SPDX-License-Identifier: GPL-3.0-or-later
/// Projection onto several surfaces at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "pamr/geometry/cone.hpp"
#include "pamr/geometry/cylinder.hpp"
#include "pamr/geometry/plane.hpp"
#include "pamr/geometry/revolution.hpp"
#include "pamr/geometry/sphere.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/torus.hpp"

namespace pamr::geometry {
namespace common_curve_test {

using Surfaces = std::vector<const Surface*>;

/// Moves each point of `curve` by up to `size` and projects it back; checks that it lands on all the surfaces, near.
template <class Curve>
void check_return(const Surfaces& surfaces, Curve curve, double size) {
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec3 on = curve(unit(random));
    const Vec3 start = on + size * Vec3{unit(random), unit(random), unit(random)};

    const Projected end = project_onto_all(surfaces, start);
    ASSERT_TRUE(end.converged) << start.x << ' ' << start.y << ' ' << start.z;
    ASSERT_LT(distance_from_all(surfaces, end.point), 2e-15 * (1 + norm(on)));
    ASSERT_LT(norm(end.point - start), 8 * size);
    const Projected again = project_onto_all(surfaces, end.point);
    ASSERT_TRUE(again.converged);
    ASSERT_LT(norm(again.point - end.point), 1e-14 * (1 + norm(on)));
  }
}

TEST(ProjectOntoAll, FindsTheCircleOfASphereAndAPlane) {
  const Sphere sphere({0, 0, 0}, 1);
  const Plane plane({0, 0.3, 0}, {0, 1, 0});
  const double radius = std::sqrt(1 - 0.09);

  check_return(
      {&sphere, &plane},
      [&](double t) {
        return Vec3{radius * std::cos(7 * t), 0.3, radius * std::sin(7 * t)};
      },
      0.1);
}

TEST(ProjectOntoAll, FindsTheCurveOfTwoCylinders) {
  const Cylinder a({0, 0, 0}, {1, 0, 0}, 0.7), b({0, 0, 0}, {0, 1, 0}, 1);

  check_return(
      {&a, &b},
      [&](double t) {
        const double y = 0.7 * std::sin(3 * t), z = 0.7 * std::cos(3 * t);
        return Vec3{std::sqrt(1 - z * z), y, z};
      },
      0.03);
}

TEST(ProjectOntoAll, FindsTheCornerOfThreeSurfaces) {
  const Sphere sphere({0.1, 0.2, 0.3}, 1);
  const Plane plane({0.2, 0, 0}, {1, 0.1, 0});
  const Cylinder tube({0, 0.2, 0}, {1, 0, 0}, 0.8);
  const Projected corner = project_onto_all(Surfaces{&sphere, &plane, &tube}, {0.2, 0.8, -0.6});
  ASSERT_TRUE(corner.converged);

  check_return(
      {&sphere, &plane, &tube}, [&](double) { return corner.point; }, 0.01);
}

TEST(ProjectOntoAll, GoesStraightToTheCornerOfThreePlanes) {
  const Plane a({1, 0, 0}, {1, 0, 0}), b({0, 2, 0}, {0, -1, 0}), c({0, 0, 3}, {1, 1, 1});
  const Plane through({1, 2, 0}, {1, -1, 0});
  const Projected corner = project_onto_all(Surfaces{&a, &b, &c}, {0, 0, 0});

  EXPECT_TRUE(corner.converged);
  EXPECT_LT(norm(corner.point - Vec3{1, 2, 0}), 1e-15);
  const Projected four = project_onto_all(Surfaces{&a, &b, &c, &through}, {0, 0, 0});
  EXPECT_TRUE(four.converged);
  EXPECT_LT(norm(four.point - Vec3{1, 2, 0}), 1e-15);
}

TEST(ProjectOntoAll, ReachesTheEdgeOfABodyFromBothSides) {
  // The end of a cone on the rim of its base disc: both surfaces stop there.
  const Revolution side({0, 0, 0}, {1, 0, 0}, {{{0, 0}, {2, 1}, {}}});
  const Revolution base({0, 0, 0}, {1, 0, 0}, {{{2, 1}, {2, 0}, {}}});

  check_return(
      {&side, &base},
      [](double t) {
        return Vec3{2, std::cos(5 * t), std::sin(5 * t)};
      },
      0.1);
}

TEST(ProjectOntoAll, IsThePlainProjectionOntoOneSurface) {
  const Torus torus({0, 0, 0}, {0, 0, 1}, 2, 0.5);
  const Vec3 p{1, 2, 0.3};

  EXPECT_EQ(project_onto_all(Surfaces{&torus}, p).point, torus.project(p));
  EXPECT_EQ(project_onto_all(Surfaces{}, p).point, p);
  EXPECT_TRUE(project_onto_all(Surfaces{}, p).converged);
}

TEST(ProjectOntoAll, TakesTheNearerOfTwoThatMeetUnderFiveDegrees) {
  const double angle = 4 * std::numbers::pi / 180;
  const Plane flat({0, 0, 0}, {0, 0, 1}), tilted({0, 0, 0}, {std::sin(angle), 0, -std::cos(angle)});
  const Vec3 low{0.5, 0.2, 0.001}, high{0.5, 0.2, 0.034};

  for (const Surfaces& surfaces : {Surfaces{&flat, &tilted}, Surfaces{&tilted, &flat}}) {
    EXPECT_EQ(project_onto_all(surfaces, low).point, flat.project(low));
    EXPECT_EQ(project_onto_all(surfaces, high).point, tilted.project(high));
    EXPECT_TRUE(project_onto_all(surfaces, high).converged);
  }
}

TEST(ProjectOntoAll, TakesTheFirstOfTwoTangentSurfacesThatAreEquallyNear) {
  const double small = std::numbers::pi / 180;
  const Plane left({0, 0, 0}, {-std::sin(small), 0, std::cos(small)});
  const Plane right({0, 0, 0}, {std::sin(small), 0, std::cos(small)});
  const Vec3 between{0, 0.2, 0.1};

  EXPECT_EQ(project_onto_all(Surfaces{&left, &right}, between).point, left.project(between));
  EXPECT_EQ(project_onto_all(Surfaces{&right, &left}, between).point, right.project(between));
}

TEST(ProjectOntoAll, KeepsAThirdSurfaceWhenTwoOfThreeAreTangent) {
  const double small = 2 * std::numbers::pi / 180;
  const Plane flat({0, 0, 0}, {0, 0, 1}), tilted({0, 0, 0}, {std::sin(small), 0, std::cos(small)});
  const Plane wall({0, 1, 0}, {0, 1, 0});
  const Projected end = project_onto_all(Surfaces{&tilted, &wall, &flat}, {0.5, 0.9, 0.001});

  EXPECT_TRUE(end.converged);
  EXPECT_LT(norm(end.point - Vec3{0.5, 1, 0}), 1e-15);
}

TEST(ProjectOntoAll, MeetsAtSixDegrees) {
  const double angle = 6 * std::numbers::pi / 180;
  const Plane flat({0, 0, 0}, {0, 0, 1}), tilted({0, 0, 0}, {std::sin(angle), 0, std::cos(angle)});
  const Projected end = project_onto_all(Surfaces{&flat, &tilted}, {0.01, 0.2, 0.001});

  EXPECT_TRUE(end.converged);
  EXPECT_LT(norm(end.point - Vec3{0, 0.2, 0}), 1e-14);
}

TEST(ProjectOntoAll, SaysThatThereIsNoCommonPoint) {
  const Sphere ball({0, 0, 0}, 1);
  const Plane above({0, 0, 1.5}, {0.2, 0, 1});
  const Projected end = project_onto_all(Surfaces{&ball, &above}, {0.3, 0.1, 1.2});
  EXPECT_FALSE(end.converged);
  EXPECT_LE(distance_from_all(Surfaces{&ball, &above}, end.point),
            distance_from_all(Surfaces{&ball, &above}, {0.3, 0.1, 1.2}));

  // Three planes that meet two by two in parallel lines.
  const Plane a({0, 0, 0}, {1, 0, 0}), b({0, 0, 0}, {0, 1, 0}), c({1, 0, 0}, {1, 1, 0});
  EXPECT_FALSE(project_onto_all(Surfaces{&a, &b, &c}, {0.1, 0.1, 0}).converged);

  // Surfaces of which one ends before it meets the other.
  const Revolution tube({0, 0, 0}, {1, 0, 0}, {{{0, 1}, {1, 1}, {}}});
  const Plane beyond({1.5, 0, 0}, {1, 0, 0});
  EXPECT_FALSE(project_onto_all(Surfaces{&tube, &beyond}, {1.2, 1, 0}).converged);
}

TEST(ProjectOntoAll, ConvergesNearTheOriginOfSurfacesWithLargeNumbers) {
  const Sphere globe({6371, 0, 0}, 6371);
  const Plane cut({0, 5000, 0}, {1, 0, 3});
  for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{1e-9, 1e-7, -1e-9}, Vec3{1e-3, 1e-2, 1e-3}}) {
    const Projected end = project_onto_all(Surfaces{&globe, &cut}, p);
    EXPECT_TRUE(end.converged);
    EXPECT_LT(distance_from_all(Surfaces{&globe, &cut}, end.point), 1e-11);
  }
}

TEST(ProjectOntoAll, DoesNotDependOnTheOrderOfSurfacesButForRounding) {
  const Sphere sphere({0, 0, 0}, 1);
  const Cone cone({-1, 0, 0}, {1, 0, 0}, 30);
  const Vec3 start{0.45, 0.8, 0.1};
  const Vec3 one = project_onto_all(Surfaces{&sphere, &cone}, start).point;
  const Vec3 two = project_onto_all(Surfaces{&cone, &sphere}, start).point;

  EXPECT_LT(norm(one - two), 1e-15);
}

TEST(DistanceFromAll, IsTheLargest) {
  const Sphere sphere({0, 0, 0}, 1);
  const Plane plane({0, 0, 0}, {0, 0, 1});

  EXPECT_EQ(distance_from_all(Surfaces{&sphere, &plane}, {3, 0, 0.5}), sphere.distance({3, 0, 0.5}));
  EXPECT_EQ(distance_from_all(Surfaces{&plane}, {3, 0, -0.5}), 0.5);
  EXPECT_EQ(distance_from_all(Surfaces{}, {3, 0, -0.5}), 0);
}

}  // namespace common_curve_test
}  // namespace pamr::geometry
