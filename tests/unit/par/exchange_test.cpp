// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/exchange.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

namespace pamr::par {
namespace exchange_test {

using testing::ElementsAre;

TEST(FindShared, FindsNothingWhereNothingIsHeld) {
  const Comm comm(MPI_COMM_WORLD);

  const auto pattern = find_shared(comm, {});

  EXPECT_TRUE(pattern.rank.empty());
  EXPECT_TRUE(pattern.item.empty());
  EXPECT_THAT(pattern.offset, ElementsAre(0));
}

TEST(FindShared, FindsNothingWhereEachRankHoldsItsOwn) {
  const Comm comm(MPI_COMM_WORLD);
  const std::vector<SharedKey> key{{comm.rank(), 100, -1}, {comm.rank(), 101, -1}};

  EXPECT_TRUE(find_shared(comm, key).rank.empty());
}

TEST(FindShared, TellsTheSameKeyFromItsParts) {
  const Comm comm(MPI_COMM_WORLD);
  // Rank 0 holds node 5, rank 1 the edge (5, 6), rank 2 the face (5, 6, 7): three different things.
  const std::vector<SharedKey> all{{5, -1, -1}, {5, 6, -1}, {5, 6, 7}, {6, -1, -1}};
  std::vector<SharedKey> key;
  if (comm.rank() < 4) key.push_back(all[static_cast<std::size_t>(comm.rank())]);

  const auto pattern = find_shared(comm, key);

  EXPECT_EQ(pattern.n_slots(), 0U);
}

TEST(FindShared, ListsAKeyOfAllRanksForEachOfTheOthers) {
  const Comm comm(MPI_COMM_WORLD);
  const std::vector<SharedKey> key{{comm.rank(), -1, -1}, {77, 78, -1}};

  const auto pattern = find_shared(comm, key);

  ASSERT_EQ(pattern.rank.size(), static_cast<std::size_t>(comm.size() - 1));
  for (std::size_t i = 0; i < pattern.rank.size(); ++i) {
    EXPECT_NE(pattern.rank[i], comm.rank());
    EXPECT_EQ(pattern.offset[i + 1] - pattern.offset[i], 1U);
    EXPECT_EQ(pattern.item[pattern.offset[i]], 1);
  }
}

TEST(FindShared, FindsNothingWhileOneRankHoldsAll) {
  const Comm comm(MPI_COMM_WORLD);
  std::vector<SharedKey> key;
  for (GlobalId i = 0; comm.is_first() && i < 100; ++i) key.push_back({i, -1, -1});

  EXPECT_EQ(find_shared(comm, key).n_slots(), 0U);
}

/// Each rank holds about half of 200 keys, in another order; the twin looks at all of them.
TEST(FindShared, AgreesWithASearchThroughAllKeysOfAllRanks) {
  const Comm comm(MPI_COMM_WORLD);
  const auto keys_of = [](Rank rank) {
    std::mt19937 engine(static_cast<unsigned>(rank) + 1);
    std::vector<SharedKey> key;
    for (GlobalId i = 0; i < 200; ++i)
      if (engine() % 2 == 0) key.push_back({i, i + static_cast<GlobalId>(7), -1});
    for (auto i = key.size(); i > 1; --i) std::swap(key[i - 1], key[engine() % i]);
    return key;
  };
  const auto mine = keys_of(comm.rank());

  const auto pattern = find_shared(comm, mine);

  std::size_t at = 0;
  for (Rank r = 0; r < comm.size(); ++r) {
    if (r == comm.rank()) continue;
    const auto theirs = keys_of(r);
    std::set<SharedKey> both;
    for (const auto& key : mine)
      if (std::find(theirs.begin(), theirs.end(), key) != theirs.end()) both.insert(key);
    ASSERT_LT(at, pattern.rank.size());
    ASSERT_EQ(pattern.rank[at], r);
    ASSERT_EQ(pattern.offset[at + 1] - pattern.offset[at], both.size());
    std::set<SharedKey> found;
    for (auto k = pattern.offset[at]; k < pattern.offset[at + 1]; ++k)
      found.insert(mine[static_cast<std::size_t>(pattern.item[k])]);
    EXPECT_EQ(found, both);
    ++at;
  }
  EXPECT_EQ(at, pattern.rank.size());
}

TEST(Exchange, SwapsValuesSlotBySlot) {
  const Comm comm(MPI_COMM_WORLD);
  // Key i is held by every rank but rank i: slots differ in number and place from rank to rank.
  std::vector<SharedKey> key;
  for (GlobalId i = 9; i >= 0; --i)
    if (i != comm.rank()) key.push_back({i, -1, -1});
  const auto pattern = find_shared(comm, key);
  std::vector<std::int64_t> mine;
  for (const auto item : pattern.item) mine.push_back(1000 * comm.rank() + key[static_cast<std::size_t>(item)][0]);

  const auto theirs = Exchange(comm, pattern).swap<std::int64_t>(mine);

  ASSERT_EQ(theirs.size(), pattern.n_slots());
  for (std::size_t i = 0; i < pattern.rank.size(); ++i)
    for (auto k = pattern.offset[i]; k < pattern.offset[i + 1]; ++k)
      EXPECT_EQ(theirs[k], 1000 * pattern.rank[i] + key[static_cast<std::size_t>(pattern.item[k])][0]);
}

TEST(Exchange, SwapsNothingWithNobody) {
  const Comm comm(MPI_COMM_WORLD);
  const Pattern nothing;

  EXPECT_TRUE(Exchange(comm, nothing).swap<double>({}).empty());
}

/// Row i of the table is (i, 10 i).
std::vector<double> block_of_table(const Comm& comm, GlobalId n) {
  std::vector<double> rows;
  const auto range = block_range(n, comm.rank(), comm.size());
  for (auto i = range.begin; i < range.end; ++i) {
    rows.push_back(static_cast<double>(i));
    rows.push_back(static_cast<double>(10 * i));
  }
  return rows;
}

TEST(FetchRows, ReturnsTheRowsAskedForInAnyOrderWithRepeats) {
  const Comm comm(MPI_COMM_WORLD);
  const GlobalId n = 23;
  const std::vector<GlobalId> ids{22, 0, comm.rank(), 7, 7, 22};

  const auto rows = fetch_rows<double>(comm, n, block_of_table(comm, n), 2, ids);

  ASSERT_EQ(rows.size(), 2 * ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    EXPECT_EQ(rows[2 * i], static_cast<double>(ids[i]));
    EXPECT_EQ(rows[2 * i + 1], static_cast<double>(10 * ids[i]));
  }
}

TEST(FetchRows, ServesOthersWhileThisRankAsksForNothing) {
  const Comm comm(MPI_COMM_WORLD);
  const GlobalId n = 5;
  const bool asks = comm.rank() == comm.size() - 1;
  const auto ids = asks ? std::vector<GlobalId>{0, 1, 2, 3, 4} : std::vector<GlobalId>{};

  const auto rows = fetch_rows<double>(comm, n, block_of_table(comm, n), 2, ids);

  EXPECT_EQ(rows.size(), asks ? 10U : 0U);
  EXPECT_TRUE(!asks || rows[9] == 40.0);
}

TEST(FetchRows, WorksWithFewerRowsThanRanks) {
  const Comm comm(MPI_COMM_WORLD);
  const std::vector<GlobalId> ids{0};

  EXPECT_THAT(fetch_rows<double>(comm, 1, block_of_table(comm, 1), 2, ids), ElementsAre(0.0, 0.0));
}

TEST(FetchRows, WorksWithAnEmptyTable) {
  const Comm comm(MPI_COMM_WORLD);

  EXPECT_TRUE(fetch_rows<double>(comm, 0, {}, 3, {}).empty());
}

TEST(ScatterRows, IsUndoneByFetchRows) {
  const Comm comm(MPI_COMM_WORLD);
  const GlobalId n = 31;
  std::vector<GlobalId> ids;  // every third row, from the end
  for (GlobalId i = n; i-- > 0;)
    if (i % comm.size() == comm.rank()) ids.push_back(i);
  std::vector<std::int64_t> rows;
  for (const auto id : ids) {
    rows.push_back(id);
    rows.push_back(-id);
  }

  const auto block = scatter_rows<std::int64_t>(comm, n, rows, 2, ids);

  const auto range = block_range(n, comm.rank(), comm.size());
  ASSERT_EQ(block.size(), static_cast<std::size_t>(2 * range.count()));
  for (auto i = range.begin; i < range.end; ++i) {
    EXPECT_EQ(block[static_cast<std::size_t>(2 * (i - range.begin))], i);
    EXPECT_EQ(block[static_cast<std::size_t>(2 * (i - range.begin) + 1)], -i);
  }
  EXPECT_EQ(fetch_rows<std::int64_t>(comm, n, block, 2, ids), rows);
}

TEST(ScatterRows, AcceptsEqualRowsFromSeveralRanksAndLeavesTheRestZero) {
  const Comm comm(MPI_COMM_WORLD);
  const std::vector<GlobalId> ids{3, 5};
  const std::vector<double> rows{0.25, 0.5};

  const auto block = scatter_rows<double>(comm, 8, rows, 1, ids);

  const std::vector<double> expected{0, 0, 0, 0.25, 0, 0.5, 0, 0};
  const auto range = block_range(8, comm.rank(), comm.size());
  EXPECT_EQ(block, std::vector<double>(expected.begin() + range.begin, expected.begin() + range.end));
}

TEST(InRounds, CoverEveryItemOnceAndCallEveryRankEquallyOften) {
  const Comm comm(MPI_COMM_WORLD);
  for (const std::size_t most : {1, 4, 100}) {
    const auto n = static_cast<std::size_t>(5 * comm.rank());
    std::size_t next = 0;
    std::int64_t calls = 0;

    in_rounds(comm, n, most, [&](std::size_t begin, std::size_t end) {
      EXPECT_EQ(begin, next);
      EXPECT_LE(end - begin, most);
      next = end;
      ++calls;
      comm.barrier();
    });

    EXPECT_EQ(next, n);
    EXPECT_EQ(calls, comm.max(calls));
    EXPECT_EQ(comm.sum(static_cast<std::int64_t>(next)), 5 * comm.size() * (comm.size() - 1) / 2);
  }
}

}  // namespace exchange_test
}  // namespace pamr::par
