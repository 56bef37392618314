// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/sorted_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace pamr {
namespace sorted_order_test {

TEST(SortedOrder, OfNothingIsNothing) { EXPECT_TRUE(sorted_order({}).empty()); }

TEST(SortedOrder, KeepsEqualKeysInTheirOrder) {
  const std::vector<std::uint64_t> key{7, 3, 7, 0, 3, 7};

  EXPECT_EQ(sorted_order(key), (std::vector<std::uint32_t>{3, 1, 4, 0, 2, 5}));
}

TEST(SortedOrder, IsThatOfAStableSort) {
  std::mt19937_64 engine(5);
  // all bits, low bits only, high bits only, few values, one word apart
  for (const std::uint64_t mask : {~std::uint64_t{0}, std::uint64_t{0xffff}, std::uint64_t{0xffff000000000000},
                                   std::uint64_t{0x8000000100000001}, std::uint64_t{0x00000fff00000000}})
    for (const std::size_t n : {1U, 2U, 100U, 5000U}) {
      std::vector<std::uint64_t> key(n);
      for (auto& k : key) k = engine() & mask;
      std::vector<std::uint32_t> expected(n);
      std::iota(expected.begin(), expected.end(), 0);
      std::stable_sort(expected.begin(), expected.end(), [&](auto a, auto b) { return key[a] < key[b]; });

      EXPECT_EQ(sorted_order(key), expected) << "mask " << mask << ", " << n << " keys";
    }
}

}  // namespace sorted_order_test
}  // namespace pamr
