// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/case_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "pamr/base/error.hpp"

namespace pamr {
namespace case_file_test {

using ::testing::ElementsAre;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

TEST(CaseFile, AcceptsTheTablesOfOtherTools) {
  const auto file = parse_case("[mesh]\nshape = 'x'\n[gas]\nfoo = 1\n[[sphere]]\n[plate]\n", "case.toml");

  EXPECT_NO_THROW(file.finish());
}

TEST(CaseFile, RefusesTablesThatNoToolKnows) {
  const auto file = parse_case("[boundry.wall]\n", "case.toml");

  EXPECT_THAT([&] { file.finish(); },
              ThrowsMessage<Error>(StrEq("case.toml:1:2: unknown key 'boundry'; did you mean 'boundary'?")));
}

TEST(CaseFile, ChecksTheTablesThatWereRead) {
  const auto file = parse_case("[gas]\nfoo = 1\n", "case.toml");
  const auto gas = file.table("gas");
  (void)gas.has("species_file");

  EXPECT_THAT([&] { file.finish(); }, ThrowsMessage<Error>(StrEq("case.toml:2:1: unknown key 'foo' in [gas]; expected "
                                                                 "one of species_file")));
}

TEST(CaseFile, KnowsTheFilesThatItNamesForAnyTool) {
  const auto files = files_of_case(
      "[[surface]]\nname = 'x'\nfile = 'body.stl'\n[[surface]]\nname = 'y'\n[[surface]]\nfile = '/abs/part.step'\n"
      "[gas]\nspecies_file = '../species.toml'\n",
      "folder/case.toml");

  EXPECT_THAT(files, ElementsAre("folder/body.stl", "/abs/part.step", "folder/../species.toml"));
  EXPECT_THAT(files_of_case("", "case.toml"), ElementsAre());
}

TEST(CaseFile, LeavesTablesOfTheWrongKindToTheToolThatReadsThem) {
  EXPECT_THAT(files_of_case("surface = 3\ngas = 'x'\n", "case.toml"), ElementsAre());
  EXPECT_THAT(files_of_case("[[surface]]\nfile = 3\n[[surface]]\nfile = 'b.stl'\n", "case.toml"), ElementsAre("b.stl"));
}

TEST(CaseFile, ListsEachTableOnce) {
  auto names = case_tables;
  std::sort(names.begin(), names.end());

  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  EXPECT_FALSE(names.front().empty());
}

}  // namespace case_file_test
}  // namespace pamr
