// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mesh/blunt_cone.hpp"
#include "mesh/meridian.hpp"
#include "mesh/sphere_in_box.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/surface.hpp"

namespace pamr::meshing {
namespace {

using geometry::Vec3;

TEST(BluntConeMeridian, AgreesWithTheModelOfTheWindTunnel) {
  const BluntConeMeridian m;

  // Coordinates of the CAD solid of the CNRS SR3 model, millimetres, six decimals.
  EXPECT_NEAR(1e3 * m.nose_end.x, 0.753842, 5e-7);
  EXPECT_NEAR(1e3 * m.nose_end.r, 4.275252, 5e-7);
  EXPECT_NEAR(1e3 * m.cone_end.x, 7.997677, 5e-7);
  EXPECT_NEAR(1e3 * m.cone_end.r, 24.177525, 5e-7);
  EXPECT_NEAR(1e3 * m.shoulder_centre.x, 9.172293, 5e-7);
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

TEST(BluntCone, CurvesLieOnTheSurfacesOfThePatchesAndEndInCommonCorners) {
  const auto domain = blunt_cone({});
  const auto surfaces = geometry::surfaces_from_toml(domain.surfaces_toml, "test");

  int n_ends = 0;
  for (const auto& curve : domain.curves) {
    for (const auto& p : curve.polyline) {
      EXPECT_LT(norm(curve.nearest(p) - p), 1e-16);
      int n_surfaces = 0;
      for (const auto& surface : surfaces.surface) n_surfaces += surface->distance(p) < 1e-15 ? 1 : 0;
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

}  // namespace
}  // namespace pamr::meshing
