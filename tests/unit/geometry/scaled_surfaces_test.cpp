// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/scaled_surfaces.hpp"

#include <gtest/gtest.h>

#include <string>

#include "pamr/base/error.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/surface_toml.hpp"

namespace pamr::geometry {
namespace {

constexpr const char* five_kinds = R"(
[[surface]]
name = "floor"
kind = "plane"
point = [0.25, 0.5, -1.0]
normal = [0.0, 0.6, 0.8]
[[surface]]
name = "ball"
kind = "sphere"
center = [1.0, 2.0, 3.0]
radius = 0.5
[[surface]]
name = "pipe"
kind = "cylinder"
point = [0.0, 1.0, 0.0]
axis = [1.0, 0.0, 1.0]
radius = 0.75
[[surface]]
name = "nose"
kind = "cone"
apex = [1.0, 0.0, 0.5]
axis = [0.0, 0.0, 1.0]
half_angle = 20.0
[[surface]]
name = "ring"
kind = "torus"
center = [0.0, 0.0, 2.0]
axis = [0.0, 1.0, 0.0]
major_radius = 3.0
minor_radius = 1.0
)";

TEST(ScaledSurfaces, HaveDistancesThatAreScaled) {
  const auto set = surfaces_from_toml(five_kinds, "five");
  for (const double factor : {0.5, 8.0, 0.001}) {
    const auto made = scaled(set, factor);
    const auto read_back = surfaces_from_toml(made.toml, "scaled");
    ASSERT_EQ(made.name, set.name);
    ASSERT_EQ(read_back.name, set.name);
    for (int s = 0; s < set.size(); ++s)
      for (const Vec3 p : {Vec3{0.3, -0.7, 1.1}, Vec3{4, 5, 6}, Vec3{-2, 0.1, 2.5}}) {
        const double expected = factor * set.get(s)->distance(p);
        EXPECT_NEAR(made.get(s)->distance(factor * p), expected, 1e-14 * factor * 10) << set.name[s] << " " << factor;
        EXPECT_EQ(read_back.get(s)->distance(factor * p), made.get(s)->distance(factor * p)) << set.name[s];
      }
  }
}

TEST(ScaledSurfaces, OfOtherKindsAreRefusedByName) {
  const auto set = surfaces_from_toml(std::string(five_kinds) + R"(
[[surface]]
name = "egg"
kind = "quadric"
coefficients = [1.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0]
)",
                                      "six");
  try {
    (void)scaled(set, 2);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("surface \"egg\" of kind quadric"), std::string::npos) << error.what();
  }
}

TEST(ScaledSurfaces, OfNoSurfacesAreNone) { EXPECT_EQ(scaled(*no_surfaces(), 3).size(), 0); }

}  // namespace
}  // namespace pamr::geometry
