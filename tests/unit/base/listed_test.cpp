// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/listed.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <string>
#include <vector>

namespace pamr {
namespace listed_test {

TEST(Listed, PutsCommasBetweenItems) {
  EXPECT_EQ(listed(std::vector<std::string>{}), "");
  EXPECT_EQ(listed(std::vector<std::string>{"A"}), "A");
  EXPECT_EQ(listed(std::set<std::string>{"C", "A", "B"}), "A, B, C");
  EXPECT_EQ(listed(std::array<std::string_view, 2>{"A", "B"}), "A, B");
}

TEST(Listed, TakesOtherWordsBeforeTheLastItem) {
  EXPECT_EQ(listed(std::vector<std::string>{"A"}, {.before_last = " and "}), "A");
  EXPECT_EQ(listed(std::vector<std::string>{"A", "B"}, {.before_last = " and "}), "A and B");
  EXPECT_EQ(listed(std::vector<std::string>{"A", "B", "C"}, {.before_last = " or "}), "A, B or C");
}

TEST(Listed, ShowsTenItemsUnlessToldOtherwise) {
  std::vector<std::string> names(10, "x");
  EXPECT_EQ(listed(names, {.before_last = " and "}), "x, x, x, x, x, x, x, x, x and x");
  names.emplace_back("y");
  EXPECT_EQ(listed(names, {.before_last = " and "}), "x, x, x, x, x, x, x, x, x, x, ...");
  EXPECT_EQ(listed(names, {.most = 2}), "x, x, ...");
  EXPECT_EQ(listed(names, {.most = all_items}), "x, x, x, x, x, x, x, x, x, x, y");
}

TEST(Listed, MakesTextsOfItems) {
  struct Part {
    std::string name;
  };
  EXPECT_EQ(listed(std::vector<Part>{{"A"}, {"B"}}, {}, &Part::name), "A, B");
  EXPECT_EQ(listed(std::vector<int>{1, 2}, {}, [](int number) { return std::to_string(number); }), "1, 2");
}

}  // namespace listed_test
}  // namespace pamr
