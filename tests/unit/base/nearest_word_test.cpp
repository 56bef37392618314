// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/nearest_word.hpp"

#include <gtest/gtest.h>

namespace pamr {
namespace nearest_word_test {

const std::vector<std::string> known{"center", "density", "radius", "temperature", "x"};

TEST(NearestWord, MendsOneLetterInThree) {
  EXPECT_EQ(nearest_word("temprature", known), "temperature");
  EXPECT_EQ(nearest_word("centre", known), "center");
  EXPECT_EQ(nearest_word("radiuss", known), "radius");
  EXPECT_EQ(nearest_word("dnesity", known), "density");
}

TEST(NearestWord, FindsNothingForAnotherWord) {
  EXPECT_EQ(nearest_word("velocity", known), std::nullopt);
  EXPECT_EQ(nearest_word("y", known), std::nullopt);
  EXPECT_EQ(nearest_word("", known), std::nullopt);
  EXPECT_EQ(nearest_word("radius", {}), std::nullopt);
}

TEST(NearestWord, TakesTheNearestAndOfEqualsTheFirst) {
  EXPECT_EQ(nearest_word("weight", {"height", "weigh"}), "height");
  EXPECT_EQ(nearest_word("widths", {"heights", "width"}), "width");
}

TEST(NearestWord, DoesNotSpendTimeOnLongWords) {
  EXPECT_EQ(nearest_word(std::string(100000, 'a'), {std::string(100000, 'a')}), std::nullopt);
}

}  // namespace nearest_word_test
}  // namespace pamr
