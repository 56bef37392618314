// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/name_pattern.hpp"

#include <gtest/gtest.h>

#include "pamr/base/error.hpp"

namespace pamr {
namespace name_pattern_test {

TEST(NamePattern, StandsForNamesAsInTheShell) {
  EXPECT_TRUE(stands_for("body_*", "body_1") && stands_for("body_*", "body_") && stands_for("*", "any"));
  EXPECT_TRUE(stands_for("face_?", "face_7") && stands_for("face_[1-3]", "face_2"));
  EXPECT_FALSE(stands_for("body_*", "body") || stands_for("face_?", "face_17") || stands_for("face_[1-3]", "face_4"));
  EXPECT_FALSE(stands_for("body", "body_1") || stands_for("Body*", "body"));
  EXPECT_TRUE(is_name_pattern("a*") && is_name_pattern("a?") && is_name_pattern("a[1]"));
  EXPECT_FALSE(is_name_pattern("wall 1.5_(b)") || is_name_pattern(""));
}

TEST(NamePattern, StandsForItsOwnLettersToo) { EXPECT_TRUE(stands_for("wall[1]", "wall[1]")); }

TEST(FindPattern, TakesTheNameItselfThenAPatternThenAny) {
  const std::vector<std::string> stated{"*", "body_*", "body_3"};
  EXPECT_EQ(find_pattern(stated, "body_3", "c"), 2U);
  EXPECT_EQ(find_pattern(stated, "body_4", "c"), 1U);
  EXPECT_EQ(find_pattern(stated, "far", "c"), 0U);
  EXPECT_EQ(find_pattern({"body_*"}, "far", "c"), std::nullopt);
  EXPECT_EQ(find_pattern({}, "far", "c"), std::nullopt);
}

TEST(FindPattern, TakesAGroupAfterTheNameAndBeforePatterns) {
  const std::vector<std::string> groups{"inlet", "hot walls"};
  EXPECT_EQ(find_pattern({"*", "hot walls", "in*"}, "inlet+hot walls", "c", groups), 1U);
  EXPECT_EQ(find_pattern({"hot walls", "inlet+hot walls", "inlet"}, "inlet+hot walls", "c", groups), 1U);
  EXPECT_EQ(find_pattern({"*", "hot*"}, "inlet+hot walls", "c", groups), 1U);
  EXPECT_EQ(find_pattern({"hot"}, "inlet+hot walls", "c", groups), std::nullopt);
  try {
    find_pattern({"*", "hot walls", "inlet"}, "inlet+hot walls", "case.toml", groups);
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "case.toml: expected one name that stands for \"inlet+hot walls\", found \"hot walls\" and \"inlet\"");
  }
}

TEST(FindPattern, RefusesTwoThatStandForOneName) {
  try {
    find_pattern({"body_*", "far", "*_1"}, "body_1", "case.toml");
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "case.toml: expected one name that stands for \"body_1\", found \"body_*\" and \"*_1\"");
  }
}

}  // namespace name_pattern_test
}  // namespace pamr
