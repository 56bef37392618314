// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/cad_body.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "meshing/bodies.hpp"
#include "meshing/inside_grid.hpp"
#include "meshing/size_sources.hpp"
#include "meshing/thickness.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/geometry/surface_toml.hpp"

namespace pamr::meshing {
namespace cad_body_test {

using geometry::Vec3;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// tests/unit/geometry/data: a cube [0, 1]^3, and a spool with a cone, tori, planes and a spline face.
std::shared_ptr<const geometry::CadModel> model(const std::string& name) {
  return geometry::make_cad_model(geometry::read_cad_source(std::string(PAMR_TEST_DATA) + "/" + name), "mm");
}

TEST(CadBody, TellsInsideFromOutsideAtFacesEdgesAndCorners) {
  const CadBody cube(model("cube.step"), 0.01);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> coordinate(-0.5, 1.5);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p{coordinate(random), coordinate(random), coordinate(random)};
    double square = 0, depth = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const double off = std::max({-p[k], p[k] - 1, 0.0});
      square += off * off;
      depth = std::min({depth, p[k], 1 - p[k]});
    }
    ASSERT_NEAR(cube.signed_distance(p), square > 0 ? std::sqrt(square) : -depth, 1e-12);
  }
}

TEST(CadBody, KnowsHowThickItIs) {
  const CadBody cube(model("cube.step"), 0.01);
  const auto triangles = cube.triangles();

  double area = 0;
  for (const auto& place : thicknesses(cube, triangles, {.spacing = 0.25, .most = 5})) {
    EXPECT_NEAR(place.thickness, 1, 0.06);  // steps of at least a hundredth of 5
    EXPECT_NEAR(cube.distance(place.point), 0, 1e-12);
    area += place.area;
  }
  EXPECT_NEAR(area, 6, 0.0625);
  for (const auto& place : thicknesses(cube, triangles, {.spacing = 0.25, .most = 0.5}))
    EXPECT_EQ(place.thickness, 0.5);
  EXPECT_LE(thicknesses(cube, triangles, {.spacing = 1e-3, .most = 5, .max_places = 200}).size(), 201U);
}

TEST(InsideGrid, HoldsPointsInsideAndAllThatAreDeepInside) {
  auto set = std::make_shared<geometry::SurfaceSet>();
  set->add("cube", "test", std::make_shared<CadBody>(model("cube.step"), 0.01));
  const Vec3 margin{0.1, 0.1, 0.1};
  const auto solid =
      std::make_shared<const Solid>(Solid{set, {Region("-cube", set->name, "test")}, -margin, Vec3{1, 1, 1} + margin});
  InsideGrid grid(solid);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> coordinate(-0.5, 1.5);

  ASSERT_TRUE(InsideGrid::is_exact_for(*solid));
  int n_held = 0;
  for (int i = 0; i < 50000; ++i) {
    const Vec3 p{coordinate(random), coordinate(random), coordinate(random)};
    const bool is_held = grid.holds(p);
    n_held += is_held;
    ASSERT_TRUE(!is_held || solid->contains(p));
    ASSERT_TRUE(is_held || std::min({p.x, p.y, p.z, 1 - p.x, 1 - p.y, 1 - p.z}) < 0.1);
  }
  EXPECT_GT(n_held, 3000);
  EXPECT_FALSE(grid.holds({NAN, 0, 0}));
}

TEST(CadBody, SidesAreThoseOfTheNearestFace) {
  const auto spool = model("spool.step");
  const CadBody body(spool, 1e-4 * spool->size());
  std::mt19937_64 random(2);
  std::normal_distribution<double> shift(0, 0.05 * spool->size());
  int n_inside = 0;
  for (const auto& face : spool->faces())
    for (std::size_t i = 0; i < face.points().size(); i += 7) {
      const Vec3 p = face.points()[i] + Vec3{shift(random), shift(random), shift(random)};
      const double distance = body.distance(p), side = body.signed_distance(p);
      if (distance < 1e-3 * spool->size()) continue;
      EXPECT_NEAR(std::abs(side), distance, 2e-4 * spool->size());
      const Vec3 foot = body.project(p);
      const auto& nearest = spool->faces()[static_cast<std::size_t>(body.piece_at(p))];
      EXPECT_LT(nearest.project(p).distance, distance + 4e-4 * spool->size());
      n_inside += side < 0;
      // on the way to the nearest point nothing is crossed
      EXPECT_EQ(body.signed_distance(p + 0.5 * (foot - p)) < 0, side < 0);
    }
  EXPECT_GT(n_inside, 20);
}

TEST(CadBody, LinesEndInCommonCornersToTheLastBit) {
  const CadBody cube(model("cube.step"), 0.01);
  ASSERT_EQ(cube.n_lines(), 12U);
  for (std::size_t i = 0; i < cube.n_lines(); ++i) {
    EXPECT_EQ(cube.pieces_of_line(i).size(), 2U);
    for (const Vec3 end : {cube.line(i).front(), cube.line(i).back()}) {
      int n_same = 0;
      for (std::size_t j = 0; j < cube.n_lines(); ++j)
        n_same += (cube.line(j).front() == end) + (cube.line(j).back() == end);
      EXPECT_EQ(n_same, 3);
    }
  }
}

TEST(CadBody, FindsTheApexOfACone) {
  const CadBody body(model("cone.step"), 0.01);
  ASSERT_EQ(body.tips().size(), 1U);
  const auto& tip = body.tips()[0];
  EXPECT_LT(norm(tip.point - Vec3{0, 0, 2}), 1e-12);
  for (const double part : {0.1, 0.6}) {
    const Vec3 p = body.around(tip, part, 0.5);
    EXPECT_NEAR(norm(p - tip.point), 0.5, 1e-9);
    EXPECT_LT(body.distance(p), 1e-12);
  }
  EXPECT_TRUE(CadBody(model("cube.step"), 0.01).tips().empty());
}

/// tests/unit/geometry/data/assembly.step: a housing [0, 2]^3, a ball of radius 0.5 in its middle, and pegs of side 1
/// at (2, 0.5, 0.5), which touches the housing, and at (5, 0, 0).
std::shared_ptr<const geometry::CadModel> assembly() {
  const auto source = geometry::read_cad_source(std::string(PAMR_TEST_DATA) + "/assembly.step");
  return geometry::make_cad_model({"assembly.brep", geometry::make_cad_assembly(source, "mm", {}).text}, "mm", true);
}

TEST(CadBody, KnowsTheSolidOfAnAssemblyAtAPoint) {
  const CadBody body(assembly(), 1e-3);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> x(-0.5, 6.5), yz(-0.5, 2.5);
  const auto is_in_box = [](Vec3 p, Vec3 low, double side) {
    return std::min({p.x - low.x, p.y - low.y, p.z - low.z}) > 0 &&
           std::max({p.x - low.x, p.y - low.y, p.z - low.z}) < side;
  };
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p{x(random), yz(random), yz(random)};
    const double from_middle = norm(p - Vec3{1, 1, 1});
    if (std::abs(from_middle - 0.5) < 2e-3) continue;
    const int solid = from_middle < 0.5                ? 1
                      : is_in_box(p, {0, 0, 0}, 2)     ? 0
                      : is_in_box(p, {2, 0.5, 0.5}, 1) ? 2
                      : is_in_box(p, {5, 0, 0}, 1)     ? 3
                                                       : -1;
    ASSERT_EQ(body.solid_at(p), solid) << p.x << " " << p.y << " " << p.z;
    ASSERT_EQ(body.signed_distance(p) < 0, solid >= 0);
  }
  EXPECT_GE(body.solid_at({2, 1, 1}), 0);  // between two: one of them
  EXPECT_EQ(body.solid_at({2, 0.2, 0.2}), -1);
  EXPECT_NEAR(body.signed_distance({1.9, 1, 1}), -0.1, 1e-12);
  EXPECT_NEAR(body.signed_distance({2.1, 1, 1}), -0.1, 1e-12);
  EXPECT_GT(body.normal({1.9, 1, 1}).x, 0.9);
  EXPECT_LT(body.normal({2.1, 1, 1}).x, -0.9);
  const double middle_of_piece = body.piece(body.outer_piece_at({2.01, 1, 1}))->distance({2, 1, 1});
  EXPECT_NEAR(middle_of_piece, 0.5, 1e-9);  // the housing's rim around the peg, or the peg's side
}

TEST(Bodies, SurfacesOfOneShapeAreOneBody) {
  const auto source = geometry::read_cad_source(std::string(PAMR_TEST_DATA) + "/cube.step");
  const auto described = [&](const std::vector<int>& others) {
    return geometry::surfaces_from_toml(
        geometry::cad_surface_table("inlet", source, "mm", std::vector<int>{1}) +
            "[[surface]]\nname = \"ball\"\nkind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 9\n" +
            geometry::cad_surface_table("rest", source, "mm", others) + geometry::cad_table(source),
        "test");
  };
  const auto set = described({2, 3, 4, 5, 6});
  EXPECT_EQ(sides_of(set), (std::vector<int>{0, 1, 0}));
  const auto bodies = join_bodies(set, 0.01);
  EXPECT_EQ(bodies.set->name, (std::vector<std::string>{"inlet", "ball"}));
  EXPECT_EQ(bodies.surface_of_face[0], (std::vector<int>{0, 2, 2, 2, 2, 2}));
  EXPECT_THAT([&] { join_bodies(described({2, 3, 5}), 0.01); }, ThrowsMessage<Error>(HasSubstr("faces = [4, 6]")));
  EXPECT_THAT(
      [&] {
        join_bodies(described({1, 2, 3, 4, 5, 6}), 0.01);
      },
      ThrowsMessage<Error>(HasSubstr("found face 1 on \"inlet\" and \"rest\"")));
}

TEST(SizeSources, TheTreeFindsTheLeastOfAll) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<SizeSources::Source> sources;
  for (int i = 0; i < 300; ++i)
    sources.push_back({{unit(random), unit(random), unit(random)}, 0.01 + 0.2 * unit(random)});
  constexpr double growth = 0.3, limit = 0.15;
  const SizeSources tree(sources, growth);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p{2 * unit(random), unit(random), unit(random)};
    double least = limit;
    for (const auto& source : sources)
      least = std::min(least, source.size + growth * std::max(0.0, norm(p - source.point) - source.size));
    ASSERT_EQ(tree.at(p, limit), least);
  }
  EXPECT_EQ(SizeSources({}, growth).at({0, 0, 0}, limit), limit);
}

}  // namespace cad_body_test
}  // namespace pamr::meshing
