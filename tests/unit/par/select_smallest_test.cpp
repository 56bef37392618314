// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/select_smallest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace pamr::par {
namespace select_smallest_test {

TEST(OrderedBits, CompareAsTheDoublesDo) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> ascending{-infinity, -1e300, -1.0, -1e-310, 0.0, 1e-310, 1.0, 1.0000000000000002, infinity};
  for (std::size_t i = 1; i < ascending.size(); ++i)
    EXPECT_LT(ordered_bits(ascending[i - 1]), ordered_bits(ascending[i]));
  EXPECT_EQ(ordered_bits(-0.0), ordered_bits(0.0));
}

TEST(SelectSmallest, ChoosesWhatSortingWouldChoose) {
  Comm comm(MPI_COMM_WORLD);
  std::mt19937_64 random(3);
  std::vector<SortKey> all(300);
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] = {ordered_bits(static_cast<double>(random() % 5) - 2.0), random() % 3, random(), 0, i};
  std::vector<SortKey> mine;
  for (const auto& key : all)
    if (static_cast<Rank>(random() % static_cast<std::uint64_t>(comm.size())) == comm.rank()) mine.push_back(key);
  std::sort(all.begin(), all.end());

  for (const std::int64_t count : {0, 1, 2, 17, 150, 299, 300, 1000}) {
    const auto chosen = select_smallest(comm, mine, count);

    ASSERT_EQ(chosen.size(), mine.size());
    for (std::size_t i = 0; i < mine.size(); ++i) {
      const auto position = std::lower_bound(all.begin(), all.end(), mine[i]) - all.begin();
      EXPECT_EQ(chosen[i], position < count ? 1 : 0) << "count " << count << " position " << position;
    }
  }
}

TEST(SelectSmallest, TakesExactlyAsManyOfEqualKeys) {
  Comm comm(MPI_COMM_WORLD);
  const std::vector<SortKey> mine(4, SortKey{1, 2, 3, 4, 5});

  const auto chosen = select_smallest(comm, mine, 3);

  EXPECT_EQ(comm.sum(std::count(chosen.begin(), chosen.end(), 1)), 3);
}

}  // namespace select_smallest_test
}  // namespace pamr::par
