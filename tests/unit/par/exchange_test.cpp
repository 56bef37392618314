// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/exchange.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "pamr/base/index.hpp"

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

/// 60 items; every rank holds those that its dice give it, in an order of its own, and knows what the others hold.
struct Held {
  explicit Held(Rank rank) {
    std::mt19937 engine(static_cast<unsigned>(rank) + 77);
    for (GlobalId i = 0; i < 60; ++i)
      if (engine() % 3 != 0) key.push_back({i, -1, -1});
    std::shuffle(key.begin(), key.end(), engine);
    std::uniform_real_distribution<double> number(-1, 1);
    std::uniform_int_distribution<int> exponent(0, 12);
    for (std::size_t i = 0; i < key.size(); ++i) value.push_back(std::ldexp(number(engine), exponent(engine)));
  }
  const double* find(const SharedKey& wanted) const {
    const auto found = std::find(key.begin(), key.end(), wanted);
    return found == key.end() ? nullptr : &value[static_cast<std::size_t>(found - key.begin())];
  }
  std::vector<SharedKey> key;
  std::vector<double> value;
};

class Fold : public testing::Test {
 protected:
  Fold() : mine_(comm_.rank()), pattern_(find_shared(comm_, mine_.key)), exchange_(comm_, pattern_) {
    for (Rank r = 0; r < comm_.size(); ++r) of_rank_.emplace_back(r);
  }
  /// What the holders of an item have, their ranks ascending.
  std::vector<double> held(const SharedKey& key) const {
    std::vector<double> values;
    for (const auto& rank : of_rank_)
      if (const auto* value = rank.find(key)) values.push_back(*value);
    return values;
  }

  Comm comm_{MPI_COMM_WORLD};
  Held mine_;
  std::vector<Held> of_rank_;
  Pattern pattern_;
  Exchange exchange_;
};

TEST_F(Fold, GivesEveryHolderTheLargestOfAll) {
  auto largest = mine_.value;

  fold_shared(exchange_, largest, [](double& mine, double theirs) { mine = std::max(mine, theirs); });

  for (std::size_t i = 0; i < largest.size(); ++i) {
    const auto all = held(mine_.key[i]);
    EXPECT_EQ(largest[i], *std::max_element(all.begin(), all.end()));
  }
}

TEST_F(Fold, TakesFromEachOtherHolderOnceInTheOrderOfRanks) {
  std::vector<std::vector<double>> taken(mine_.key.size());

  fold_shared(
      exchange_, [&](LocalId i) { return -mine_.value[at(i)]; },
      [&](LocalId i, double theirs) { taken[at(i)].push_back(theirs); });

  for (std::size_t i = 0; i < taken.size(); ++i) {
    std::vector<double> others;
    for (Rank r = 0; r < comm_.size(); ++r)
      if (const auto* value = of_rank_[at(r)].find(mine_.key[i]); value != nullptr && r != comm_.rank())
        others.push_back(-*value);
    EXPECT_EQ(taken[i], others);
  }
}

TEST_F(Fold, InRankOrderAddsAsOneRankWould) {
  auto sum = mine_.value;

  fold_in_rank_order(exchange_, sum, [](double a, double b) { return a + b; });

  for (std::size_t i = 0; i < sum.size(); ++i) {
    const auto all = held(mine_.key[i]);
    double expected = all.front();
    for (std::size_t k = 1; k < all.size(); ++k) expected += all[k];
    EXPECT_EQ(sum[i], expected);
  }
}

TEST_F(Fold, InRankOrderKeepsTheOrderOfAJoinThatIsNotCommutative) {
  auto first = mine_.value;
  auto halved = mine_.value;

  fold_in_rank_order(exchange_, first, [](double a, double) { return a; });
  fold_in_rank_order(exchange_, halved, [](double a, double b) { return a / 2 - b; });

  for (std::size_t i = 0; i < first.size(); ++i) {
    const auto all = held(mine_.key[i]);
    double expected = all.front();
    for (std::size_t k = 1; k < all.size(); ++k) expected = expected / 2 - all[k];
    EXPECT_EQ(first[i], all.front());
    EXPECT_EQ(halved[i], expected);
  }
}

TEST_F(Fold, RaisesAFlagAtEveryHolder) {
  const auto is_raised = [](double value) { return std::fmod(std::floor(value), 4) == 1; };
  std::vector<std::uint8_t> flag;
  for (const auto value : mine_.value) flag.push_back(is_raised(value) ? 1 : 0);

  fold_flags(exchange_, flag);

  for (std::size_t i = 0; i < flag.size(); ++i) {
    const auto all = held(mine_.key[i]);
    EXPECT_EQ(flag[i] != 0, std::any_of(all.begin(), all.end(), is_raised));
  }
}

TEST_F(Fold, HasOneFirstHolderOfEachItem) {
  const auto is_first = held_first_here(exchange_, mine_.key.size());

  for (std::size_t i = 0; i < is_first.size(); ++i) {
    Rank lowest = 0;
    while (of_rank_[at(lowest)].find(mine_.key[i]) == nullptr) ++lowest;
    EXPECT_EQ(is_first[i] != 0, lowest == comm_.rank());
  }
}

TEST_F(Fold, WorksOnAPartOfThePattern) {
  const auto third = [](const SharedKey& key) { return key[0] % 3 == 0; };
  std::vector<LocalId> new_number(mine_.key.size(), invalid_local);
  std::vector<double> largest;
  std::vector<SharedKey> key;
  for (std::size_t i = 0; i < mine_.key.size(); ++i) {
    if (!third(mine_.key[i])) continue;
    new_number[i] = static_cast<LocalId>(largest.size());
    largest.push_back(mine_.value[i]);
    key.push_back(mine_.key[i]);
  }
  const auto part = restricted(pattern_, [&](std::size_t slot) { return new_number[at(pattern_.item[slot])]; });

  fold_shared(Exchange(comm_, part), largest, [](double& mine, double theirs) { mine = std::max(mine, theirs); });

  for (std::size_t i = 0; i < largest.size(); ++i) {
    const auto all = held(key[i]);
    EXPECT_EQ(largest[i], *std::max_element(all.begin(), all.end()));
  }
}

TEST(Restricted, LeavesOutNeighborsWithoutASlot) {
  const Pattern whole{{1, 3, 5}, {0, 2, 3, 5}, {10, 11, 12, 13, 14}};

  const auto part = restricted(whole, [](std::size_t slot) { return slot == 2 ? invalid_local : LocalId(slot); });

  EXPECT_THAT(part.rank, ElementsAre(1, 5));
  EXPECT_THAT(part.offset, ElementsAre(0, 2, 4));
  EXPECT_THAT(part.item, ElementsAre(0, 1, 3, 4));
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

TEST(ScatterRows, KeepsTheRowOfTheHighestRank) {
  const Comm comm(MPI_COMM_WORLD);
  const GlobalId n = 30;
  std::vector<GlobalId> ids;  // rank 0 gives all, the others some
  for (GlobalId i = 0; i < n; ++i)
    if (i % (comm.rank() + 1) == 0) ids.push_back(i);
  const std::vector<Rank> rows(ids.size(), comm.rank());

  const auto block = scatter_rows<Rank>(comm, n, rows, 1, ids);

  const auto range = block_range(n, comm.rank(), comm.size());
  for (auto i = range.begin; i < range.end; ++i) {
    Rank highest = 0;
    for (Rank r = 0; r < comm.size(); ++r)
      if (i % (r + 1) == 0) highest = r;
    EXPECT_EQ(block[static_cast<std::size_t>(i - range.begin)], highest) << i;
  }
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
