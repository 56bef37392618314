// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/insertion_sort.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <utility>
#include <vector>

namespace pamr {
namespace insertion_sort_test {

bool key_is_less(const std::pair<int, int>& a, const std::pair<int, int>& b) { return a.first < b.first; }

TEST(InsertionSort, AgreesWithAStableSortOnListsWithEqualItems) {
  std::mt19937 random(7);
  for (std::size_t length = 0; length <= 12; ++length)
    for (int trial = 0; trial < 50; ++trial) {
      std::vector<std::pair<int, int>> items;
      for (std::size_t i = 0; i < length; ++i) items.emplace_back(static_cast<int>(random() % 4), static_cast<int>(i));
      auto expected = items;
      std::stable_sort(expected.begin(), expected.end(), key_is_less);
      insertion_sort(std::span(items), key_is_less);
      EXPECT_EQ(items, expected);
    }
}

TEST(InsertionSort, SortsAPartOfAnArrayAndNothingBeside) {
  std::array<int, 6> items{9, 3, 2, 1, 8, 0};
  insertion_sort(std::span(items).subspan(1, 3), [](int a, int b) { return a < b; });
  EXPECT_EQ(items, (std::array<int, 6>{9, 1, 2, 3, 8, 0}));
}

}  // namespace insertion_sort_test
}  // namespace pamr
