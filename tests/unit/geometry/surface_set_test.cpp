// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/surface_set.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "pamr/base/error.hpp"
#include "pamr/geometry/described_surface.hpp"
#include "pamr/geometry/surface_toml.hpp"

namespace pamr::geometry {
namespace surface_set_test {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

SurfaceSet of_every_described_kind() {
  const std::array described{
      described_plane("floor", 2, -1.0 / 3), described_sphere("ball", digits(Vec3{0.1, 0.2, 0.3}), digits(2.0 / 7)),
      described_cylinder("tube", whole(Vec3{}), whole(Vec3{1, 0, 0}), whole(2)),
      described_revolution("body", {{{0, 0}, {0.1, 0.1}, ProfileArc{{0.1, 0}, {}}}, {{0.1, 0.1}, {1.0 / 3, 0.1}, {}}})};
  return set_of(described, "test");
}

TEST(DescribedSurface, IsWhatIsReadBackFromItsDescriptionToTheLastBit) {
  const auto made = of_every_described_kind();

  const auto read = surfaces_from_toml(made.toml, "test");

  EXPECT_EQ(read.name, made.name);
  for (const Vec3 p : {Vec3{0.3, 0.7, 0.9}, Vec3{-1, 0.2, -0.4}, Vec3{0.05, 0.04, 0.02}})
    for (int i = 0; i < made.size(); ++i) {
      EXPECT_EQ(read.get(i)->project(p), made.get(i)->project(p)) << made.name[static_cast<std::size_t>(i)];
      EXPECT_EQ(read.get(i)->normal(p), made.get(i)->normal(p)) << made.name[static_cast<std::size_t>(i)];
    }
}

TEST(DescribedSurface, ShortestNumbersAreReadBackToTheLastBit) {
  const auto place = shortest({0.1, -0.0, 1.0 / 3}), axis = shortest({0, 0, 1});
  const std::array described{described_cone("a \"b\" \\", place, axis, shortest(std::atan(0.5))),
                             described_torus("ring", place, axis, shortest(2), shortest(0.6)),
                             described_plane("far", shortest({0, 0, 12345678901234567890.0}), axis)};
  const auto made = set_of(described, "test");

  const auto read = surfaces_from_toml(made.toml, "test");

  EXPECT_EQ(read.name, made.name);
  for (const Vec3 p : {Vec3{0.3, 0.7, 0.9}, Vec3{-1, 0.2, -0.4}, Vec3{0.1, -0.5, 0.02}})
    for (int i = 0; i < made.size(); ++i) EXPECT_EQ(read.get(i)->project(p), made.get(i)->project(p)) << i;
}

TEST(DescribedSurface, WritesWholeNumbersAndDigits) {
  EXPECT_EQ(described_sphere("s", whole(Vec3{0, -1, 0}), digits(0.1)).toml,
            "[[surface]]\nname = \"s\"\nkind = \"sphere\"\ncenter = [0.0, -1.0, 0.0]\nradius = 0.10000000000000001\n");
}

TEST(SurfaceSet, FindsByNameAndIndex) {
  const auto set = of_every_described_kind();

  EXPECT_EQ(set.index_of("tube"), 2);
  EXPECT_EQ(set.find("tube"), set.get(2));
  EXPECT_EQ(set.index_of("sky"), -1);
  EXPECT_EQ(set.get(-1), nullptr);
  EXPECT_EQ(set.get(4), nullptr);
  EXPECT_EQ(no_surfaces()->size(), 0);
}

TEST(SurfaceSet, AppendsSurfacesWithTheirDescriptions) {
  auto set = of_every_described_kind();
  const auto* ball = set.find("ball");
  const std::array more{described_plane("roof", 2, 5)};

  set.append(set_of(more, "more"));

  EXPECT_THAT(set.name, ElementsAre("floor", "ball", "tube", "body", "roof"));
  EXPECT_EQ(set.find("ball"), ball);
  EXPECT_EQ(surfaces_from_toml(set.toml, "test").name, set.name);
  EXPECT_THAT([&] { set.append(set_of(more, "more")); },
              ThrowsMessage<Error>(AllOf(HasSubstr("more: surface \"roof\""), HasSubstr("twice"))));
}

}  // namespace surface_set_test
}  // namespace pamr::geometry
