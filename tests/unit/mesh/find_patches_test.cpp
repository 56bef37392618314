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

TEST(FindPatches, NamesThePatchesWhereNoneIsFound) {
  EXPECT_THAT(require_patches(patches, "wall?", "--patch"), ElementsAre(0));
  EXPECT_THAT(
      [] { (void)require_patches(patches, "wall", "--patch"); },
      ::testing::ThrowsMessage<Error>("--patch: expected a patch of the mesh (wall1, wall[1], inlet), found \"wall\""));
  EXPECT_EQ(list_patches({}), "none");
}

}  // namespace find_patches_test
}  // namespace pamr::mesh
