// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/memory.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace pamr {
namespace memory_test {

constexpr std::size_t large_page = std::size_t{2} << 20U;

TEST(Memory, LongArraysFillLargePagesTogetherWithTheAllocatorsWords) {
  for (const std::size_t bytes : {4 * large_page, 4 * large_page + 1, 5 * large_page - 64, 64 * large_page - 63}) {
    const auto filled = fill_large_pages(bytes);
    EXPECT_GE(filled, bytes);
    EXPECT_LE(filled, bytes + large_page);
    const auto rest = filled % large_page;  // what is left for the allocator is a few words
    EXPECT_GE(rest, large_page - 64) << bytes;
  }
}

TEST(Memory, ShortArraysAreAskedForAsTheyAre) {
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{1}, large_page, 4 * large_page - 1})
    EXPECT_EQ(fill_large_pages(bytes), bytes);
}

TEST(Memory, ReservedArraysHaveRoomForTheirItemsAndStartEmpty) {
  struct Item {
    double value[3];
  };
  for (const std::size_t n : {std::size_t{0}, std::size_t{7}, std::size_t{1} << 20U}) {
    std::vector<Item> items;
    reserve_array(items, n);
    EXPECT_TRUE(items.empty());
    EXPECT_GE(items.capacity(), n);
    EXPECT_LE(items.capacity() * sizeof(Item), n * sizeof(Item) + large_page);
  }
}

TEST(Memory, AssignedArraysHoldTheValueEverywhere) {
  std::vector<int> items{1, 2, 3};
  assign_array(items, 3 << 20U, 17);
  EXPECT_EQ(items.size(), std::size_t{3} << 20U);
  EXPECT_TRUE(std::all_of(items.begin(), items.end(), [](int i) { return i == 17; }));
}

}  // namespace memory_test
}  // namespace pamr
