// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/find_patches.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pamr/base/error.hpp"

namespace pamr::mesh {
namespace find_patches_test {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const std::vector<Patch> patches{{"wall1", ""}, {"wall[1]", ""}, {"inlet", ""}};

TEST(FindPatches, TakesThePatchOfThatNameAloneOrAllOfAPattern) {
  EXPECT_THAT(find_patches(patches, "wall[1]"), ElementsAre(1));
  EXPECT_THAT(find_patches(patches, "wall[12]"), ElementsAre(0));
  EXPECT_THAT(find_patches(patches, "*l*"), ElementsAre(0, 1, 2));
  EXPECT_THAT(find_patches(patches, "wall"), IsEmpty());
  EXPECT_THAT(find_patches({}, "*"), IsEmpty());
}

TEST(FindPatches, TakesThePatchesInAGroupOfThatName) {
  const std::vector<Patch> some{{"wing", ""},
                                {.name = "wing+upper", .kind = "", .groups = {{7, "wing"}, {9, "upper"}}},
                                {.name = "wing+lower", .kind = "", .groups = {{7, "wing"}, {8, "lower"}}},
                                {"inlet", ""}};

  EXPECT_THAT(find_patches(some, "wing"), ElementsAre(0, 1, 2));
  EXPECT_THAT(find_patches(some, "upper"), ElementsAre(1));
  EXPECT_THAT(find_patches(some, "wing+lower"), ElementsAre(2));
  EXPECT_THAT(find_patches(some, "*er"), ElementsAre(1, 2));
  EXPECT_THAT(find_patches(some, "7"), IsEmpty());
}

TEST(FindPatches, NamesThePatchesWhereNoneIsFound) {
  EXPECT_THAT(require_patches(patches, "wall?", "--patch"), ElementsAre(0));
  EXPECT_THAT(
      [] { (void)require_patches(patches, "wall", "--patch"); },
      ::testing::ThrowsMessage<Error>("--patch: expected a patch of the mesh (wall1, wall[1], inlet), found \"wall\""));
  EXPECT_EQ(list_patches({}), "none");
}

}  // namespace find_patches_test
}  // namespace pamr::mesh
