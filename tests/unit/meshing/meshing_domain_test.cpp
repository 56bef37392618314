// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "meshing/blunt_cone.hpp"
#include "meshing/combination.hpp"
#include "meshing/meridian.hpp"
#include "meshing/region.hpp"
#include "meshing/sphere_in_box.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/described_surface.hpp"

namespace pamr::meshing {
namespace meshing_domain_test {

using geometry::Vec3;

TEST(BluntConeMeridian, AgreesWithTheModelOfTheWindTunnel) {
  const BluntConeMeridian m;

  // Coordinates of the CAD solid of the CNRS SR3 model, millimeters, six decimals.
  EXPECT_NEAR(1e3 * m.nose_end.x, 0.753842, 5e-7);
  EXPECT_NEAR(1e3 * m.nose_end.r, 4.275252, 5e-7);
  EXPECT_NEAR(1e3 * m.cone_end.x, 7.997677, 5e-7);
  EXPECT_NEAR(1e3 * m.cone_end.r, 24.177525, 5e-7);
  EXPECT_NEAR(1e3 * m.shoulder_center.x, 9.172293, 5e-7);
  EXPECT_NEAR(1e3 * m.shoulder_end.x, 10.422293, 5e-7);
  EXPECT_NEAR(1e3 * m.fillet_end.x, 12.502293, 5e-7);
}

TEST(BluntConeMeridian, InsideTestAndProfileDescribeOneBody) {
  const BluntConeMeridian m;

  for (const auto& p : sample(m.body(), 20, 20)) {
    if (p.x <= 0 || p.x == m.shoulder_end.x) continue;  // in the tip and on the base inside depends on x alone
    EXPECT_TRUE(m.is_in_body({p.x, p.r - 1e-9})) << p.x << " " << p.r;
    EXPECT_FALSE(m.is_in_body({p.x, p.r + 1e-9})) << p.x << " " << p.r;
  }
  for (const auto& p : sample(m.outer(), 20, 20)) {
    if (p.x <= m.inflow_x) continue;
    EXPECT_FALSE(m.is_beyond_outer({p.x, p.r - 1e-9})) << p.x << " " << p.r;
    EXPECT_TRUE(m.is_beyond_outer({p.x, p.r + 1e-9})) << p.x << " " << p.r;
  }
}

TEST(BluntCone, LabelsWhatLiesBehindEachPatch) {
  const auto domain = blunt_cone({});

  EXPECT_EQ(domain.label({-0.01, 0.01, 0}), Domain::inside);
  EXPECT_EQ(domain.label({0.03, 0.01, 0.01}), Domain::inside);
  EXPECT_EQ(domain.label({0.0001, 0.0001, 0}), 0);
  EXPECT_EQ(domain.label({0.0092, 0.0249, 0}), 0);
  EXPECT_EQ(domain.label({0.0104, 0.02, 0}), 1);
  EXPECT_EQ(domain.label({0.011, 0.0065, 0}), 1);
  EXPECT_EQ(domain.label({0.03, 0.006, 0}), 2);
  EXPECT_EQ(domain.label({-0.031, 0.01, 0}), 3);
  EXPECT_EQ(domain.label({0.03, 0.061, 0}), 3);
  EXPECT_EQ(domain.label({-0.029, 0.059, 0}), 3);
  EXPECT_EQ(domain.label({0.061, 0.03, 0}), 4);
  EXPECT_EQ(domain.label({0.03, -0.001, 0.02}), 5);
}

TEST(BluntCone, HasAllTheGasWithinItsOuterRadius) {
  const auto domain = blunt_cone({}, {.outer_radius = 0.09});

  EXPECT_EQ(domain.label({0.03, 0.089, 0}), Domain::inside);
  EXPECT_EQ(domain.label({0.03, 0.091, 0}), 3);
  EXPECT_EQ(domain.label({-0.029, 0.059, 0}), Domain::inside);
  EXPECT_EQ(domain.label({-0.029, 0.089, 0}), 3);
  EXPECT_GT(domain.radius, std::hypot(0.09, 0.045));
  EXPECT_THROW(blunt_cone({}, {.outer_radius = 0.04}), Error);
}

TEST(BluntCone, EndsAtItsOutflow) {
  const auto domain = blunt_cone({}, {.outflow = 0.03});

  EXPECT_EQ(domain.label({0.029, 0.03, 0}), Domain::inside);
  EXPECT_EQ(domain.label({0.031, 0.03, 0}), 4);
  EXPECT_THROW(blunt_cone({}, {.outflow = 0.015}), Error);
}

TEST(BluntCone, CurvesLieOnTheSurfacesOfThePatchesAndEndInCommonCorners) {
  const auto domain = blunt_cone({}, {.outer_radius = 0.08, .outflow = 0.04});

  int n_ends = 0;
  for (const auto& curve : domain.curves) {
    for (const auto& p : curve.polyline) {
      EXPECT_LT(norm(curve.nearest(p) - p), 1e-16);
      int n_surfaces = 0;
      for (const auto& surface : domain.surfaces->surface) n_surfaces += surface->distance(p) < 1e-15 ? 1 : 0;
      EXPECT_GE(n_surfaces, 1);
    }
    for (const auto& end : {curve.polyline.front(), curve.polyline.back()}) {
      int n_curves = 0;
      for (const auto& other : domain.curves)
        n_curves += other.polyline.front() == end || other.polyline.back() == end ? 1 : 0;
      EXPECT_GE(n_curves, 3) << end.x << " " << end.y << " " << end.z;
      ++n_ends;
    }
  }
  EXPECT_EQ(n_ends, 24);
}

TEST(BluntCone, SizesGrowNoFasterThanAskedFor) {
  const BluntConeSizes sizes;
  const auto domain = blunt_cone(sizes);

  for (int i = 0; i < 1000; ++i) {
    const Vec3 p{-0.03 + 9e-5 * i, 0.02 + 0.02 * std::sin(i), 0.02 * std::cos(3 * i)};
    const Vec3 q = p + 1e-4 * Vec3{std::sin(2 * i), std::cos(2 * i), 0};
    EXPECT_LE(std::abs(domain.size(p) - domain.size(q)), sizes.growth * 1e-4 * (1 + 1e-9));
    EXPECT_GE(domain.size(p), sizes.shoulder);
    EXPECT_LE(domain.size(p), sizes.far);
  }
}

TEST(BluntCone, ScaledSizesStayWithinTheirLimitsOnArcs) {
  const auto coarse = BluntConeSizes::scaled_to(15e-3), fine = BluntConeSizes::scaled_to(5e-3);

  EXPECT_EQ(coarse.shoulder, BluntConeSizes{}.shoulder);
  EXPECT_EQ(coarse.far, 15e-3);
  EXPECT_DOUBLE_EQ(fine.shoulder, 0.5 * BluntConeSizes{}.shoulder);
  EXPECT_NO_THROW(blunt_cone(coarse));
}

TEST(BluntCone, RefusesSizesOutOfRange) {
  BluntConeSizes sizes;
  sizes.fillet = 2e-3;

  EXPECT_THAT([&] { blunt_cone(sizes); }, testing::ThrowsMessage<Error>(testing::HasSubstr("fillet")));
}

TEST(SphereInBox, LabelsItsSidesAndTheBall) {
  const auto domain = sphere_in_box(0.3);

  EXPECT_EQ(domain.label({1.5, 0, 0}), Domain::inside);
  EXPECT_EQ(domain.label({0.5, 0.5, 0.5}), 6);
  EXPECT_EQ(domain.label({-2.1, 2, 0}), 0);
  EXPECT_EQ(domain.label({2.1, 0, 0}), 1);
  EXPECT_EQ(domain.label({0, 0, -2.1}), 4);
  EXPECT_EQ(domain.label({0, 0, 2.1}), 5);
  EXPECT_EQ(domain.curves.size(), 12U);
}

TEST(Region, CombinesSides) {
  const std::vector<std::string> names{"a", "b", "c"};
  const Region region("+a & (-b | !(+c))", names, "test");

  for (Sides sides = 0; sides < 8; ++sides) {
    const bool a = (sides & 1U) != 0, b = (sides & 2U) != 0, c = (sides & 4U) != 0;
    EXPECT_EQ(region.contains(sides), a && (!b || !c)) << sides;
  }
}

TEST(Region, AndBindsBeforeOr) {
  const std::vector<std::string> names{"a", "b", "c"};
  const Region region("+a | +b & -c", names, "test");

  EXPECT_TRUE(region.contains(0b101));
  EXPECT_TRUE(region.contains(0b010));
  EXPECT_FALSE(region.contains(0b110));
}

TEST(Region, RefusesWhatItCannotRead) {
  const std::vector<std::string> names{"a", "b"};

  for (const char* text : {"", "+a", "+a +b", "+a & ", "(+a | +b", "+a & +b)", "a & +b", "+a & +d", "+a % +b"})
    EXPECT_THAT([&] { Region(text, names, "where"); }, testing::ThrowsMessage<Error>(testing::StartsWith("where: ")))
        << text;
  EXPECT_THROW(Region(std::string(1000, '(') + "+a & +b", names, "where"), Error);
}

TEST(Region, NeedNotUseAllNamesAmongOthers) {
  const std::vector<std::string> names{"a", "b", "c"};
  const auto region = Region::among_others("+a & !(-c)", names, std::vector{0, 1, 1}, "test");

  EXPECT_EQ(region.used(), 0b11U);
  EXPECT_TRUE(region.contains(0b11));
  EXPECT_FALSE(region.contains(0b01));
}

geometry::DescribedSurface unit_ball() {
  return described_sphere("ball", geometry::whole(geometry::Vec3{}), geometry::whole(1));
}

geometry::SharedSurfaces shared(const std::vector<geometry::DescribedSurface>& surfaces) {
  return std::make_shared<const geometry::SurfaceSet>(geometry::set_of(surfaces, "test"));
}

/// The unit ball without the sector x > 0, y > 0: two planes that make a reentrant edge along z.
Combination notched_ball() {
  Combination c;
  c.surfaces = shared({unit_ball(), geometry::described_plane("x", 0, 0), geometry::described_plane("y", 1, 0)});
  c.region = "-ball & (-x | -y)";
  c.low = {-1, -1, -1};
  c.high = {1, 1, 1};
  c.length_unit = "1";
  c.far = 0.5;
  c.growth = 0.3;
  c.near = {{"ball", 0.2}};
  return c;
}

TEST(Combination, LabelsWhatLiesBehindEachSurface) {
  const auto domain = combine(notched_ball(), "test");

  EXPECT_EQ(domain.label({-0.5, 0.1, 0}), Domain::inside);
  EXPECT_EQ(domain.label({-2, 0, 0}), 0);
  EXPECT_EQ(domain.label({0.1, 0.3, 0}), 1);
  EXPECT_EQ(domain.label({0.3, 0.1, 0}), 2);
}

TEST(Combination, FindsEdgesAndCornersButNoTracesOfPlanesInside) {
  const auto domain = combine(notched_ball(), "test");

  // the edge along z, and a half circle in each plane: from pole to pole all of them
  ASSERT_EQ(domain.curves.size(), 3U);
  for (const auto& curve : domain.curves) {
    EXPECT_NEAR(std::abs(curve.polyline.front().z), 1, 1e-12);
    EXPECT_EQ(curve.polyline.front().x, 0);
    EXPECT_TRUE(curve.polyline.front() == domain.curves[0].polyline.front() ||
                curve.polyline.front() == domain.curves[0].polyline.back());
    for (const auto& p : curve.polyline) {
      EXPECT_TRUE(p.x >= 0 && p.y >= 0 && (p.x == 0 || p.y == 0));
      EXPECT_LE(norm(p), 1 + 1e-12);
      EXPECT_LT(norm(curve.nearest(p) - p), 1e-12);
    }
  }
}

TEST(Combination, SizesGrowFromTheirSurface) {
  const auto domain = combine(notched_ball(), "test");

  EXPECT_DOUBLE_EQ(domain.size({-0.9, 0, 0}), 0.2);
  EXPECT_NEAR(domain.size({-0.5, 0, 0}), 0.2 + 0.3 * 0.3, 1e-12);
}

TEST(Combination, RefusesARegionThatTouchesItselfAlongACurve) {
  auto c = notched_ball();
  c.region = "-ball & ((+x & +y) | (-x & -y))";

  EXPECT_THAT([&] { combine(c, "test"); }, testing::ThrowsMessage<Error>(testing::HasSubstr("touch itself")));
}

TEST(Combination, StartsFromPointsOnASurfaceThatNoEdgeTouches) {
  Combination c = notched_ball();
  c.surfaces = shared({unit_ball()});
  c.region = "-ball";
  c.far = 2;
  c.near.clear();
  const auto domain = combine(c, "test");

  EXPECT_TRUE(domain.curves.empty());
  EXPECT_EQ(domain.pieces[0].start.size(), 6U);
  for (const auto& p : domain.pieces[0].start) EXPECT_NEAR(norm(p), 1, 1e-15);
}

/// The unit ball in three parts that meet in a line along z; the first and the last are one region.
Combination parted_ball() {
  auto c = notched_ball();
  c.region.clear();
  c.parts = {{"a", "-ball & -x", "test:1"}, {"b", "-ball & +x & -y", "test:2"}, {"a", "-ball & +x & +y", "test:3"}};
  return c;
}

TEST(Combination, LabelsRegionsAndHasAPieceForEachTwo) {
  const auto domain = combine(parted_ball(), "test");

  EXPECT_EQ(domain.label({-0.5, 0.1, 0}), Domain::in_region(0));
  EXPECT_EQ(domain.label({0.3, -0.5, 0}), Domain::in_region(1));
  EXPECT_EQ(domain.label({0.3, 0.5, 0}), Domain::in_region(2));
  ASSERT_EQ(domain.regions.size(), 3U);
  EXPECT_EQ(domain.regions[0].number, 1);
  EXPECT_EQ(domain.regions[1].number, 2);
  EXPECT_EQ(domain.regions[2].number, 1);
  const auto behind = [&](Vec3 p) { return domain.pieces.at(static_cast<std::size_t>(domain.label(p))); };
  EXPECT_EQ(behind({-1.1, 0.1, 0}).region, (std::array{0, -1}));
  EXPECT_EQ(behind({0.3, -1.1, 0}).region, (std::array{1, -1}));
  EXPECT_EQ(behind({0.3, 1.1, 0}).region, (std::array{2, -1}));
  std::vector<std::pair<int, std::array<int, 2>>> pieces;
  for (const auto& piece : domain.pieces) pieces.emplace_back(piece.patch, piece.region);
  EXPECT_THAT(pieces, testing::UnorderedElementsAre(std::pair(0, std::array{0, -1}), std::pair(0, std::array{1, -1}),
                                                    std::pair(0, std::array{2, -1}), std::pair(1, std::array{0, 1}),
                                                    std::pair(1, std::array{0, 2}), std::pair(2, std::array{1, 2})));
}

TEST(Combination, FindsEdgesBetweenRegions) {
  const auto domain = combine(parted_ball(), "test");

  // the line along z, two half circles in the plane x and one in the plane y: from pole to pole all of them
  ASSERT_EQ(domain.curves.size(), 4U);
  for (const auto& curve : domain.curves) {
    EXPECT_NEAR(std::abs(curve.polyline.front().z), 1, 1e-12);
    EXPECT_NEAR(std::abs(curve.polyline.back().z), 1, 1e-12);
    for (const auto& p : curve.polyline) EXPECT_TRUE(p.x == 0 || (p.y == 0 && p.x >= 0));
  }
}

TEST(Combination, RefusesRegionsThatOverlapAreEmptyOrTouchAlongAnEdgeAlone) {
  const auto refuses = [](std::vector<NamedRegion> parts, const char* text) {
    auto c = notched_ball();
    c.parts = std::move(parts);
    EXPECT_THAT([&] { combine(c, "test"); }, testing::ThrowsMessage<Error>(testing::HasSubstr(text)));
  };

  refuses({{"a", "-ball & -x", "test:1"}, {"b", "-ball & -y", "test:2"}}, R"(] in "a" (test:1) and in "b" (test:2))");
  refuses({{"a", "-ball & -x & +y", "test:1"}, {"b", "-ball & +x & -x", "test:2"}},
          R"(region "b" (test:2), found none)");
  refuses({{"a", "-ball & -x & +y", "test:1"}, {"b", "-ball & +x & -y", "test:2"}}, "along an edge alone");
  refuses({{"a", "-ball & -x", "test:1"}, {"b", "-ball & +x", "test:2"}}, R"(found "y" in none)");
  refuses({{"a", "-ball & -x", "test:1"}, {"b", "-ball & +x & (-y | +y)", "test:2"}}, R"(no place where "y" does)");
  refuses({{"a", "-ball & -x & -z", "test:1"}}, "test:1: expected the name of a surface");
}

}  // namespace meshing_domain_test
}  // namespace pamr::meshing
