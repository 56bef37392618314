// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/triangulated_surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/geometry/triangulated/self_intersection.hpp"
#include "support/triangulations.hpp"

namespace pamr::geometry {
namespace triangulated_surface_test {

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

/// The largest distances of a triangulated unit ball from the ball: of its triangles, of the surface through them, and of
/// the surface's normals from the ball's.
struct Distances {
  double flat = 0, curved = 0, normals = 0;
};

Distances distances_from_ball(const Triangulation& triangles, const Triangulated& surface) {
  Distances most;
  for_points_of(triangles, [&](Vec3 p) {
    const Vec3 q = surface.project(p);
    most.flat = std::max(most.flat, distance_from_ball(p));
    most.curved = std::max(most.curved, distance_from_ball(q));
    most.normals = std::max(most.normals, norm(surface.normal(q) - (1 / norm(q)) * q));
  });
  return most;
}

TEST(Triangulated, OfACoarseSphereIsFiftyTimesNearerToTheSphereThanItsTriangles) {
  const auto triangles = testing::icosphere(2);
  const Triangulated surface(triangles, {});

  const auto [flat, curved, normals] = distances_from_ball(triangles, surface);

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

/// Beside a sharp edge the nearest flat triangle may be one from which no way leads to the edge.
TEST(Triangulated, HasItsSharpEdgesAtNoDistance) {
  for (const int n : {8, 16}) {
    const Triangulated surface(testing::lens(n, 12, 0.9), {});
    for (int i = 0; i < 1000; ++i) {
      const double angle = 2 * M_PI * i / 1000;
      const Vec3 on_edge = surface.project_to_seam({std::cos(angle), std::sin(angle), 0});
      ASSERT_LT(surface.distance(on_edge), 1e-14) << n << ", point " << i;
    }
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

// Over the rim the flat triangles of the lid are nearer than those of the bore, which lie up to 0.0043 from the bore itself.
TEST(Triangulated, FindsTheNearerSideOfACrease) {
  const Triangulated surface(testing::bored_cube(24), {});

  for (int i = 0; i < 240; ++i) {
    const double angle = 2 * M_PI * i / 240;
    const Vec3 wall = surface.project(0.497 * Vec3{std::cos(angle), std::sin(angle), 0} + Vec3{0, 0, 0.9});
    EXPECT_LT(surface.project({wall.x, wall.y, 0.999}).z, 0.9995) << i;
  }
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

/// Distance from the cube with the round hole, negative in it; exact near its walls, edges and rims.
double distance_from_bored_cube(Vec3 p) {
  const double x = std::abs(p.x) - 1, y = std::abs(p.y) - 1, z = std::abs(p.z) - 1, r = 0.5 - std::hypot(p.x, p.y);
  const double deepest = std::max({x, y, z, r});
  if (deepest <= 0) return deepest;
  return norm({std::max(x, 0.0), std::max(y, 0.0), std::hypot(std::max(z, 0.0), std::max(r, 0.0))});
}

TEST(Triangulated, TellsInsideFromOutsideBesideEdgesAndCorners) {
  const Triangulated surface(testing::bored_cube(24), {});

  for (int i = 0; i < 4000; ++i) {
    const Vec3 p{1.3 * std::sin(1.1 * i), 1.3 * std::sin(1.7 * i + 1), 1.3 * std::sin(2.3 * i + 2)};
    const double exact = distance_from_bored_cube(p);
    const double found = surface.signed_distance(p);
    if (std::abs(exact) > 1e-3) {
      EXPECT_EQ(found < 0, exact < 0) << p.x << " " << p.y << " " << p.z;
    }
    if (std::abs(exact) < 0.2) {
      EXPECT_NEAR(found, exact, 3e-4) << p.x << " " << p.y << " " << p.z;
    }
  }
  EXPECT_LT(surface.signed_distance({0.999, 0.999, 0.999}), 0);
  EXPECT_NEAR(surface.signed_distance({1.3, 1.4, 1}), 0.5, 1e-15);
  EXPECT_NEAR(surface.signed_distance({1.3, 1.4, 2.2}), 1.3, 1e-15);
}

TEST(Triangulated, TakesPiecesAloneAndCreasesAsLines) {
  const Triangulated surface(testing::bored_cube(24), {});

  std::size_t n_closed = 0;
  for (const auto& line : surface.crease_net().lines()) n_closed += line.is_closed() ? 1 : 0;
  EXPECT_EQ(surface.crease_net().lines().size(), 14U);  // 12 edges of the cube, 2 rims
  EXPECT_EQ(n_closed, 2U);
  for (const Vec3 p : {Vec3{0.9, 0.9, 1.2}, {0.4, 0, 0.3}, {-1.2, 0.3, 0.3}}) {
    const auto alone = surface.piece(surface.piece_at(p));
    EXPECT_EQ(alone->project(p), surface.project(p));
    EXPECT_TRUE(alone->is_one_piece());
  }
  const auto top = surface.piece(surface.piece_at({0.9, 0.9, 1.2}));
  EXPECT_TRUE(top->is_flat());
  EXPECT_EQ(top->project({0.9, 0.9, -5}), (Vec3{0.9, 0.9, 1}));
}

TEST(Triangulated, TakesCreasesThatAreGiven) {
  Triangulated::Options options;
  options.crease.angle = 180;
  EXPECT_EQ(Triangulated(testing::bored_cube(24), options).n_patches(), 1U);
  for (const double z : {-1.0, 1.0})
    options.crease.given.push_back({{1, 1, z}, {-1, 1, z}, {-1, -1, z}, {1, -1, z}, {1, 1, z}});
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0}) options.crease.given.push_back({{x, y, -1}, {x, y, 1}});

  const Triangulated surface(testing::bored_cube(24), options);

  EXPECT_EQ(surface.n_creases(), 12U);
  EXPECT_EQ(surface.n_patches(), 5U);  // the four sides, and the rest, smooth over the rims
  options.crease.given.push_back({{1, 1, 1}, {-1, -0.9, 1}});
  EXPECT_THAT([&] { Triangulated(testing::bored_cube(24), options); },
              ::testing::ThrowsMessage<Error>(::testing::HasSubstr("segment 1 of polyline 7")));
}

/// Two parts of a sphere about one of its corners: triangles whose middles lie higher than `height` over its center.
std::shared_ptr<const NamedParts> cap_and_rest(const Triangulation& sphere, double height) {
  NamedParts parts{{"cap", "rest"}, {}};
  const auto point = [&](int p) { return sphere.points[static_cast<std::size_t>(p)]; };
  for (const auto& [a, b, c] : sphere.triangles)
    parts.part.push_back(dot((1.0 / 3) * (point(a) + point(b) + point(c)), point(0)) > height ? 0 : 1);
  return std::make_shared<const NamedParts>(std::move(parts));
}

TEST(Triangulated, StaysSmoothWhereNamedPartsMeet) {
  const auto triangles = testing::icosphere(2);
  for (const double height : {0.0, 0.9}) {  // a large circle of 20 edges, a small one of 10
    Triangulated::Options options;
    options.parts = cap_and_rest(triangles, height);
    const Triangulated surface(triangles, options), without(triangles, {});

    const auto [flat, curved, normals] = distances_from_ball(triangles, surface);

    EXPECT_EQ(surface.n_patches(), 2U);
    ASSERT_EQ(surface.crease_net().lines().size(), 1U);
    EXPECT_TRUE(surface.crease_net().lines()[0].is_closed());
    EXPECT_EQ(surface.n_creases(), height > 0 ? 10U : 20U);
    for (const Vec3 p : surface.crease_net().lines()[0].polyline) EXPECT_LT(distance_from_ball(p), 2e-3) << height;
    EXPECT_GT(flat / curved, height > 0 ? 5 : 50);
    EXPECT_LT(normals, height > 0 ? 0.05 : 0.005);
    EXPECT_EQ(surface.part_of(surface.piece_at(triangles.points[0])), "cap");
    EXPECT_EQ(surface.part_of(surface.piece_at(-triangles.points[0])), "rest");
    EXPECT_EQ(surface.piece(0)->part_of(0), "");
    EXPECT_EQ(surface.project(-triangles.points[0]), without.project(-triangles.points[0]));
  }
}

TEST(Triangulated, KeepsBordersOfPartsSharpWhereTheyAreSharpWithoutNames) {
  const auto cube = testing::bored_cube(24);
  NamedParts parts{{"upper", "lower"}, {}};
  for (const auto& triangle : cube.triangles) {
    double height = 0;
    for (const int p : triangle) height += cube.points[static_cast<std::size_t>(p)].z;
    parts.part.push_back(height > 2.9 ? 0 : 1);  // the upper face
  }
  Triangulated::Options options;
  options.parts = std::make_shared<const NamedParts>(parts);
  const Triangulated surface(cube, options), without(cube, {});

  EXPECT_EQ(surface.n_patches(), without.n_patches());
  EXPECT_EQ(surface.n_creases(), without.n_creases());
  for (const Vec3 p : {Vec3{0.9, 0.9, 1.2}, {0.4, 0, 0.3}, {-1.2, 0.3, 0.3}, {0.5, 0.1, 1.1}})
    EXPECT_EQ(surface.project(p), without.project(p));
}

TEST(Triangulated, RefusesBordersThatAreNoEdges) {
  Triangulated::Options options;
  options.crease.borders = {{0, 0}};

  EXPECT_THAT([&] { Triangulated(testing::icosphere(0), options); },
              ::testing::ThrowsMessage<Error>(::testing::HasSubstr("border_edges: expected the two points of edges")));
}

/// A sphere with one crease of two edges in it.
Triangulated::Options with_inner_crease(const Triangulation& sphere) {
  const auto corner = [&](std::size_t t, std::size_t k) {
    return sphere.points[static_cast<std::size_t>(sphere.triangles[t][k])];
  };
  Triangulated::Options options;
  options.crease.given = {{corner(0, 0), corner(0, 1)}};
  return options;
}

TEST(Triangulated, KeepsNodesOnACreaseThatEndsInside) {
  const auto sphere = testing::icosphere(2);
  const auto options = with_inner_crease(sphere);
  const Vec3 a = options.crease.given[0][0], b = options.crease.given[0][1];

  const Triangulated surface(sphere, options);

  ASSERT_EQ(surface.n_creases(), 1U);
  EXPECT_EQ(surface.n_patches(), 1U);
  const Vec3 c = surface.project({0.3, -0.2, 1}), d = surface.project({-0.2, 0.1, 1});
  const auto middle = surface.crease_between(a, b, c, d);
  ASSERT_TRUE(middle.has_value());
  EXPECT_EQ(*middle, surface.crease_net().nearest(midpoint(a, b)));
  EXPECT_EQ(middle, surface.crease_between(b, a, d, c));
  EXPECT_FALSE(surface.crease_between(a, c, b, d).has_value());
}

TEST(Triangulated, KeepsNodesOnACreaseBetweenItsPiecesWhereTheTrianglesBesideSaySo) {
  const Triangulated surface(testing::bored_cube(24), {});
  const Vec3 a{1, 1, 0}, b{1, 1, 0.5}, on_x{1, 0.5, 0.2}, on_y{0.5, 1, 0.2}, on_top{0.7, 0.7, 1};

  EXPECT_EQ(surface.crease_between(a, b, on_x, on_y), (Vec3{1, 1, 0.25}));
  EXPECT_EQ(surface.crease_between(b, a, on_y, on_x), (Vec3{1, 1, 0.25}));
  EXPECT_FALSE(surface.crease_between(a, b, on_x, {1, 0.4, 0.3}).has_value()) << "both triangles in one plane";
  EXPECT_FALSE(surface.crease_between(a, {1, 0.9, 0.5}, on_x, on_y).has_value()) << "an end beside the crease";
  EXPECT_FALSE(surface.crease_between({1, 1, 1}, {1, 0.9, 0.9}, on_x, on_top).has_value()) << "an end inside a plane";
}

TEST(Triangulated, TakesNodesOnTheChordsOfACreaseForItsNodes) {
  const Triangulated surface(testing::bored_cube(24), {});
  const auto& points = testing::bored_cube(24).points;
  std::vector<Vec3> rim;
  for (const Vec3 p : points)
    if (p.z == 1 && std::abs(std::hypot(p.x, p.y) - 0.5) < 1e-9) rim.push_back(p);
  ASSERT_EQ(rim.size(), 24U);
  std::sort(rim.begin(), rim.end(), [](Vec3 p, Vec3 q) { return std::atan2(p.y, p.x) < std::atan2(q.y, q.x); });
  const Vec3 a = midpoint(rim[0], rim[1]), b = midpoint(rim[2], rim[3]), out = 1.5 * midpoint(rim[1], rim[2]);
  const Vec3 on_top{out.x, out.y, 1}, on_bore{rim[1].x, rim[1].y, 0.6};

  const auto middle = surface.crease_between(a, b, on_top, on_bore);

  ASSERT_TRUE(middle.has_value());
  EXPECT_NEAR(std::hypot(middle->x, middle->y), 0.5, 1e-6);
  EXPECT_EQ(middle->z, 1);
  EXPECT_FALSE(surface.crease_between(a, b, on_top, {1.2 * out.x, 1.2 * out.y, 1}).has_value());
}

TEST(Triangulated, TakesShortCreasesThatEndInsideForNoise) {
  const auto sphere = testing::icosphere(2);
  auto options = with_inner_crease(sphere);
  const double length = norm(options.crease.given[0][1] - options.crease.given[0][0]);

  options.crease.shortest = 0.9 * length;
  EXPECT_EQ(Triangulated(sphere, options).n_creases(), 1U);
  options.crease.shortest = 1.1 * length;
  EXPECT_EQ(Triangulated(sphere, options).n_creases(), 0U);
}

TEST(SelfIntersections, AreFoundWhereTwoSpheresCutEachOther) {
  auto surface = testing::icosphere(2);
  EXPECT_EQ(find_self_intersections(surface).n_pairs, 0);
  EXPECT_EQ(self_intersection_warning(surface, {}), "");
  EXPECT_FALSE(cuts_itself(surface));
  const auto n = static_cast<int>(surface.points.size());
  for (int i = 0; i < n; ++i)
    surface.points.push_back(surface.points[static_cast<std::size_t>(i)] + Vec3{1.01, 0.02, 0.03});
  for (std::size_t t = 0; t < 320; ++t) {
    auto corner = surface.triangles[t];
    for (int& p : corner) p += n;
    surface.triangles.push_back(corner);
  }
  surface.name = "pair";

  const auto found = find_self_intersections(surface);

  EXPECT_GT(found.n_pairs, 20);
  EXPECT_NEAR(found.first.where.x, 0.5, 0.3);
  EXPECT_TRUE(cuts_itself(surface));
  EXPECT_THAT(self_intersection_warning(surface, found),
              ::testing::AllOf(::testing::HasSubstr("\"pair\""),
                               ::testing::HasSubstr(std::to_string(found.n_pairs) + " pairs")));
}

TEST(Triangulated, RefusesOptionsOutOfRange) {
  Triangulated::Options options;
  options.crease.angle = 181;
  EXPECT_THROW(Triangulated(testing::icosphere(0), options), Error);
  options.crease.angle = 40;
  options.near = Vec3{0, 0, std::nan("")};
  EXPECT_THROW(Triangulated(testing::icosphere(0), options), Error);
}

}  // namespace triangulated_surface_test
}  // namespace pamr::geometry
