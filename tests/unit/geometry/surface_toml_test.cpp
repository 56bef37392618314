// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/surface_toml.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "pamr/base/error.hpp"
#include "pamr/geometry/surface.hpp"

namespace pamr::geometry {
namespace surface_toml_test {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

constexpr std::string_view every_kind = R"(
[[surface]]
name = "floor"
kind = "plane"
point = [0, 0, -1]
normal = [0, 0, 2]

[[surface]]
name = "ball"
kind = "sphere"
center = [1, 2.5, -3e0]
radius = 2

[[surface]]
name = "tube"
kind = "cylinder"
point = [0, 0, 0]
axis = [1, 0, 0]
radius = 0.5

[[surface]]
name = "tip"
kind = "cone"
apex = [0, 0, 0]
axis = [0, 0, 1]
half_angle = 45

[[surface]]
name = "ring"
kind = "torus"
center = [0, 0, 0]
axis = [0, 0, 1]
major_radius = 2
minor_radius = 0.5

[[surface]]
name = "body"
kind = "revolution"
origin = [0, 0, 0]
axis = [1, 0, 0]
profile = [
  { from = [0, 0], to = [1, 1], center = [1, 0] },
  { from = [1, 1], to = [3, 1] },
  { from = [3, 1], to = [3, 0], center = [3, 0.5], clockwise = true },
]

[[surface]]
name = "egg"
kind = "quadric"
coefficients = [1, 1, 0.25, 0, 0, 0, -2, 0, 0, 0]

[[surface]]
name = "dish"
kind = "polynomial"
segments = [
  { x = [0, 1, 0, 0, 0, 0], y = [0, 0, 1, 0, 0, 0], z = [5, 0, 0, 1, 0, 1], u = [-1, 0], v = [-1, 1] },
  { x = [0, 1, 0, 0, 0, 0], y = [0, 0, 1, 0, 0, 0], z = [5, 0, 0, 1, 0, 1], u = [0, 1], v = [-1, 1] },
]
)";

auto reading(const std::string& text) {
  return [text] { surfaces_from_toml(text, "case.toml"); };
}
template <class... Parts>
auto refuses(const std::string& start, Parts... parts) {
  return ThrowsMessage<Error>(AllOf(StartsWith("case.toml:" + start), HasSubstr(parts)...));
}

TEST(SurfacesFromToml, ReadsEveryKindInOrder) {
  const SurfaceSet set = surfaces_from_toml(every_kind, "case.toml");

  EXPECT_THAT(set.name, ElementsAre("floor", "ball", "tube", "tip", "ring", "body", "egg", "dish"));
  ASSERT_EQ(set.surface.size(), 8U);
  EXPECT_NEAR(set.find("floor")->distance({5, 5, 1}), 2, 1e-15);
  EXPECT_NEAR(set.find("ball")->distance({1, 2.5, 0}), 1, 1e-15);
  EXPECT_NEAR(set.find("tube")->distance({9, 2, 0}), 1.5, 1e-15);
  EXPECT_NEAR(set.find("tip")->distance({1, 0, 1}), 0, 1e-15);
  EXPECT_NEAR(set.find("ring")->distance({0, 3, 0}), 0.5, 1e-15);
  EXPECT_NEAR(set.find("body")->distance({2, 0, 3}), 2, 1e-15);
  EXPECT_NEAR(set.find("body")->distance({4, 0.5, 0}), 0.5, 1e-15);
  EXPECT_NEAR(set.find("egg")->distance({1, 0, 5}), 3, 1e-15);  // (x - 1)^2 + y^2 + z^2 / 4 = 1
  EXPECT_NEAR(set.find("egg")->distance({4, 0, 0}), 2, 1e-15);
  EXPECT_NEAR(set.find("dish")->distance({0, 0, 4}), 1, 1e-15);
  EXPECT_EQ(set.find("sky"), nullptr);
  EXPECT_EQ(set.index_of("ball"), 1);
  EXPECT_EQ(set.get(8), nullptr);
  EXPECT_EQ(set.toml, every_kind);
}

TEST(SurfacesFromToml, AcceptsTextWithoutSurfaces) {
  EXPECT_TRUE(surfaces_from_toml("", "case.toml").name.empty());
  EXPECT_TRUE(surfaces_from_toml("# nothing here\n", "case.toml").surface.empty());
}

TEST(SurfacesFromToml, RefusesTextThatIsNotToml) {
  EXPECT_THAT(reading("[[surface]]\nname = \"a\nkind = 1\n"), refuses("2:10: missing quote"));
  EXPECT_THAT(reading("[[surface]]\nname = \"a\"\nname = \"b\"\n"), refuses("3:8: expected TOML"));
}

TEST(SurfacesFromToml, RefusesUnknownKeysAndKinds) {
  EXPECT_THAT(reading("[[surfaces]]\nname = \"a\"\n"), refuses("1:3: unknown key 'surfaces'", "surface"));
  EXPECT_THAT(reading("\n[[surface]]\nname = \"a\"\nkind = \"cube\"\n"),
              refuses("4:8: expected kind = \"plane\", \"sphere\"", "in surface \"a\"", "\"cube\""));
  EXPECT_THAT(reading("[[surface]]\nname = \"a\"\nkind = \"sphere\"\ncenter = [0,0,0]\nradius = 1\ncolour = 3\n"),
              refuses("6:1: unknown key 'colour' in surface \"a\""));
  EXPECT_THAT(reading("[[surface]]\nname = \"a\"\nkind = \"revolution\"\norigin = [0,0,0]\naxis = [1,0,0]\n"
                      "profile = [ {from = [0,1], to = [1,1]},\n {from = [1,1], to = [2,1], centr = [1,2]} ]\n"),
              refuses("7:29: unknown key 'centr'", "surface \"a\": profile piece 2", "center"));
}

TEST(SurfacesFromToml, RefusesMissingKeys) {
  EXPECT_THAT(reading("\n\n[[surface]]\nkind = \"sphere\"\n"), refuses("3:1: ", "name = a text in surface 1", "none"));
  EXPECT_THAT(reading("[[surface]]\nname = \"a\"\n"), refuses("1:1: ", "kind = ", "in surface \"a\"", "none"));
  EXPECT_THAT(reading("[[surface]]\nname = \"a\"\nkind = \"sphere\"\ncenter = [0, 0, 0]\n"),
              refuses("1:1: ", "radius = a number in surface \"a\"", "none"));
}

TEST(SurfacesFromToml, RefusesWrongTypesAndSizes) {
  const std::string start = "[[surface]]\nname = \"a\"\nkind = \"sphere\"\n";
  EXPECT_THAT(reading(start + "center = [0, 0]\nradius = 1\n"),
              refuses("4:10: ", "center = an array of 3 numbers", "array of 2"));
  EXPECT_THAT(reading(start + "center = 7\nradius = 1\n"),
              refuses("4:10: ", "center = an array of 3 numbers", "found 7"));
  EXPECT_THAT(reading(start + "center = [0, 0, \"x\"]\nradius = 1\n"), refuses("4:17: ", "3 numbers", "\"x\""));
  EXPECT_THAT(reading(start + "center = [0, 0, 0]\nradius = true\n"), refuses("5:10: ", "radius = a number", "true"));
  EXPECT_THAT(reading("surface = 3\n"), refuses("1:11: ", "tables [[surface]]", "3"));
  EXPECT_THAT(reading("surface = [ 1, 2 ]\n"), refuses("1:13: ", "a table [[surface]]", "1"));
  EXPECT_THAT(reading("[surface]\nname = \"a\"\n"), refuses("1:1: ", "tables [[surface]]", "a table"));
  EXPECT_THAT(reading("[[surface]]\nname = 4\n"), refuses("2:8: ", "name = a text", "4"));
  EXPECT_THAT(reading("[[surface]]\nname = \"\"\n"), refuses("2:8: ", "name = a text"));
}

TEST(SurfacesFromToml, RefusesNumbersThatAreNotFinite) {
  const std::string start = "[[surface]]\nname = \"a\"\nkind = \"sphere\"\n";
  EXPECT_THAT(reading(start + "center = [0, nan, 0]\nradius = 1\n"), refuses("4:14: ", "center", "numbers", "nan"));
  EXPECT_THAT(reading(start + "center = [0, 0, 0]\nradius = inf\n"), refuses("5:10: ", "radius", "a number", "inf"));
}

TEST(SurfacesFromToml, RefusesValuesOutOfRangeWithTheLineOfTheSurface) {
  EXPECT_THAT(reading("\n[[surface]]\nname = \"a\"\nkind = \"sphere\"\ncenter = [0,0,0]\nradius = -1\n"),
              refuses("6:10: surface \"a\": radius:", "greater than zero", "-1"));
  EXPECT_THAT(reading("[[surface]]\nname = \"a\"\nkind = \"plane\"\npoint = [0,0,0]\nnormal = [0,0,0]\n"),
              refuses("5:10: surface \"a\": normal:", "not zero"));
  EXPECT_THAT(reading("[[surface]]\nname = \"a\"\nkind = \"cone\"\napex = [0,0,0]\naxis = [0,0,1]\nhalf_angle = 90\n"),
              refuses("6:14: surface \"a\": half_angle:", "between 0 and 90", "90"));
  EXPECT_THAT(reading("[[surface]]\nname = \"a\"\nkind = \"torus\"\ncenter = [0,0,0]\naxis = [0,0,1]\n"
                      "major_radius = 1\nminor_radius = 2\n"),
              refuses("7:16: surface \"a\": minor_radius:", "less than", "2"));
  EXPECT_THAT(reading("[[surface]]\nname = \"a\"\nkind = \"revolution\"\norigin = [0,0,0]\naxis = [1,0,0]\n"
                      "profile = [ {from = [0,1], to = [1,1]},\n {from = [1.5,1], to = [2,1]} ]\n"),
              refuses("6:11: surface \"a\": profile piece 2:", "[1, 1]", "[1.5, 1]"));
  EXPECT_THAT(
      reading("[[surface]]\nname = \"a\"\nkind = \"revolution\"\norigin = [0,0,0]\naxis = [1,0,0]\nprofile = []\n"),
      refuses("6:11: ", "profile = an array of one table or more"));
  EXPECT_THAT(reading("[[surface]]\nname = \"a\"\nkind = \"revolution\"\norigin = [0,0,0]\naxis = [1,0,0]\n"
                      "profile = [ {from = [0,1], to = [1,1], clockwise = true} ]\n"),
              refuses("6:13: ", "center = ", "surface \"a\": profile piece 1"));
}

TEST(SurfacesFromToml, RefusesQuadricsThatAreNoSurface) {
  const auto quadric = [](const std::string& coefficients) {
    return reading("[[surface]]\nname = \"a\"\nkind = \"quadric\"\ncoefficients = [" + coefficients + "]\n");
  };
  EXPECT_THAT(quadric("1, 1, 1"), refuses("4:16: ", "coefficients = an array of 10 numbers", "array of 3"));
  EXPECT_THAT(quadric("0, 0, 0, 0, 0, 0, 1, 2, 3, 4"), refuses("4:16: ", "a square or a product", "none"));
  EXPECT_THAT(quadric("1, 1, 1, 0, 0, 0, 0, 0, 0, 2"), refuses("4:16: ", "zero somewhere", "never is"));
  EXPECT_THAT(quadric("-1, -1, 0, 0, 0, 0, 0, 0, 0, -2"), refuses("4:16: ", "zero somewhere", "never is"));
  EXPECT_THAT(quadric("1, 2, 3, 0, 0, 0, 0, 0, 0, 0"), refuses("4:16: ", "a point, a line"));
  EXPECT_THAT(quadric("1, 2, 0, 0, 0, 0, -2, 0, 0, 1"), refuses("4:16: ", "a point, a line"));
}

TEST(SurfacesFromToml, RefusesSegmentsThatAreNoSurface) {
  const auto segments = [](const std::string& text) {
    return reading("[[surface]]\nname = \"a\"\nkind = \"polynomial\"\nsegments = [" + text + "]\n");
  };
  const std::string start = "{x = [0, 1, 0, 0, 0, 0], y = [0, 0, 1, 0, 0, 0], z = [0, 0, 0, 0, 0, 0], ";
  EXPECT_THAT(segments(""), refuses("4:12: ", "segments = an array of one table or more"));
  EXPECT_THAT(segments(start + "u = [0, 1]}"), refuses("4:13: ", "v = ", "surface \"a\": segment 1", "none"));
  EXPECT_THAT(segments(start + "u = [0, 1], v = [1, 1]}"), refuses("4:12: ", "segment 1: v:", "the greater one last"));
  EXPECT_THAT(segments(start + "u = [0, 1], v = [0, 1], w = 3}"), refuses("4:110: unknown key 'w'", "segment 1"));
  EXPECT_THAT(segments("{x = [0, 1, 1, 0, 0, 0], y = [0, 2, 2, 0, 0, 0], z = [0, 0, 0, 0, 0, 0], u = [0, 1], "
                       "v = [0, 1]}"),
              refuses("4:12: ", "segment 1: expected a surface", "a curve or a point"));
}

TEST(SurfacesFromToml, RefusesANameTwice) {
  const std::string ball = "[[surface]]\nname = \"a\"\nkind = \"sphere\"\ncenter = [0,0,0]\nradius = 1\n";
  EXPECT_THAT(reading(ball + ball), refuses("7:8: surface \"a\":", "twice"));
}

}  // namespace surface_toml_test
}  // namespace pamr::geometry
