// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/comm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::par {
namespace comm_test {

using testing::ElementsAre;

TEST(Comm, HasItsOwnCopyOfTheCommunicator) {
  const Comm comm(MPI_COMM_WORLD);

  EXPECT_NE(comm.handle(), MPI_COMM_WORLD);
  EXPECT_LT(comm.rank(), comm.size());
  EXPECT_EQ(comm.is_first(), comm.rank() == 0);
}

TEST(Comm, ReducesIntegersExactlyBeyond32Bits) {
  const Comm comm(MPI_COMM_WORLD);
  const auto p = static_cast<std::int64_t>(comm.size());
  const std::int64_t big = std::int64_t{1} << 40U;

  EXPECT_EQ(comm.sum(big + comm.rank()), p * big + p * (p - 1) / 2);
  EXPECT_EQ(comm.min(big - comm.rank()), big - (p - 1));
  EXPECT_EQ(comm.max(big + comm.rank()), big + p - 1);
  EXPECT_EQ(comm.exclusive_sum(big), big * comm.rank());
}

TEST(Comm, SumsArraysElementByElement) {
  const Comm comm(MPI_COMM_WORLD);
  std::vector<std::int64_t> values{1, comm.rank(), -2};
  const auto p = static_cast<std::int64_t>(comm.size());

  comm.sum_in_place(values);

  EXPECT_THAT(values, ElementsAre(p, p * (p - 1) / 2, -2 * p));
}

TEST(Comm, FindsTheGreatestOfArraysElementByElement) {
  const Comm comm(MPI_COMM_WORLD);
  std::vector<std::int64_t> values{1, comm.rank(), -comm.rank()};

  comm.max_in_place(values);

  EXPECT_THAT(values, ElementsAre(1, comm.size() - 1, 0));
}

TEST(Comm, SumsAnEmptyArray) {
  const Comm comm(MPI_COMM_WORLD);
  std::vector<std::int64_t> none;

  comm.sum_in_place(none);

  EXPECT_TRUE(none.empty());
}

TEST(Comm, SeesAConditionThatHoldsOnOneRankOnly) {
  const Comm comm(MPI_COMM_WORLD);
  const bool is_last = comm.rank() == comm.size() - 1;

  EXPECT_TRUE(comm.any(is_last));
  EXPECT_FALSE(comm.any(false));
  EXPECT_TRUE(comm.all(true));
  EXPECT_EQ(comm.all(is_last), comm.size() == 1);
}

TEST(Comm, GathersOneValueFromEveryRankInRankOrder) {
  const Comm comm(MPI_COMM_WORLD);
  std::vector<std::int64_t> expected;
  for (Rank r = 0; r < comm.size(); ++r) expected.push_back(10 * r + 1);

  EXPECT_EQ(comm.all_gather(std::int64_t{10} * comm.rank() + 1), expected);
}

TEST(Comm, BroadcastsTextAndRowsOfAnyRankEvenEmptyOnes) {
  const Comm comm(MPI_COMM_WORLD);
  const Rank last = comm.size() - 1;
  const bool is_last = comm.rank() == last;

  EXPECT_EQ(comm.broadcast(is_last ? std::string("grüß dich\n") : "other", last), "grüß dich\n");
  EXPECT_EQ(comm.broadcast(is_last ? std::string() : "other", last), "");
  EXPECT_THAT(comm.broadcast(is_last ? std::vector<double>{0.5, -2} : std::vector<double>{7}, last),
              ElementsAre(0.5, -2));
}

TEST(SparseExchange, DeliversToEveryRankInRankOrder) {
  const Comm comm(MPI_COMM_WORLD);
  std::vector<Outgoing<std::int64_t>> messages;
  for (Rank r = comm.size(); r-- > 0;)  // rank r is sent r + 1 items
    messages.push_back({r, std::vector<std::int64_t>(static_cast<std::size_t>(r) + 1, 100 * comm.rank() + r)});

  const auto received = comm.sparse_exchange(messages);

  ASSERT_EQ(received.rank.size(), static_cast<std::size_t>(comm.size()));
  for (Rank r = 0; r < comm.size(); ++r) {
    const auto at = static_cast<std::size_t>(r);
    EXPECT_EQ(received.rank[at], r);
    const auto items = received.from(at);
    EXPECT_EQ(items.size(), static_cast<std::size_t>(comm.rank()) + 1);
    EXPECT_TRUE(std::all_of(items.begin(), items.end(), [&](std::int64_t x) { return x == 100 * r + comm.rank(); }));
  }
}

TEST(SparseExchange, WorksWhenNobodyHasAnythingToSay) {
  const Comm comm(MPI_COMM_WORLD);

  const auto received = comm.sparse_exchange(std::vector<Outgoing<int>>{});

  EXPECT_TRUE(received.rank.empty());
  EXPECT_TRUE(received.item.empty());
  EXPECT_THAT(received.offset, ElementsAre(0));
}

TEST(SparseExchange, DropsEmptyMessages) {
  const Comm comm(MPI_COMM_WORLD);
  const std::vector<Outgoing<int>> messages{{(comm.rank() + 1) % comm.size(), {}}};

  EXPECT_TRUE(comm.sparse_exchange(messages).rank.empty());
}

TEST(SparseExchange, LetsOneRankReceiveWhatItDidNotExpect) {
  const Comm comm(MPI_COMM_WORLD);
  const Rank last = comm.size() - 1;
  std::vector<Outgoing<int>> messages;
  if (comm.rank() != last) messages.push_back({last, {comm.rank()}});

  const auto received = comm.sparse_exchange(messages);

  EXPECT_EQ(received.rank.size(), comm.rank() == last ? static_cast<std::size_t>(last) : 0U);
  for (std::size_t i = 0; i < received.rank.size(); ++i) EXPECT_THAT(received.from(i), ElementsAre(received.rank[i]));
}

TEST(SparseExchange, KeepsConsecutiveExchangesApart) {
  const Comm comm(MPI_COMM_WORLD);

  for (int round = 0; round < 50; ++round) {
    const Rank to = (comm.rank() + round) % comm.size();
    const Rank from = (comm.rank() + comm.size() * 50 - round) % comm.size();

    const auto received = comm.sparse_exchange(std::vector<Outgoing<int>>{{to, {round, comm.rank()}}});

    ASSERT_THAT(received.rank, ElementsAre(from));
    ASSERT_THAT(received.item, ElementsAre(round, from));
  }
}

TEST(SparseExchange, CarriesLargeMessages) {
  const Comm comm(MPI_COMM_WORLD);
  std::vector<std::int64_t> items(300'000);
  std::iota(items.begin(), items.end(), 1'000'000 * comm.rank());
  const Rank previous = (comm.rank() + comm.size() - 1) % comm.size();

  const auto received =
      comm.sparse_exchange(std::vector<Outgoing<std::int64_t>>{{(comm.rank() + 1) % comm.size(), items}});

  ASSERT_EQ(received.item.size(), items.size());
  EXPECT_EQ(received.item.front(), 1'000'000 * previous);
  EXPECT_EQ(received.item.back(), 1'000'000 * previous + 299'999);
}

TEST(SparseExchange, CountsWhatItSendsToOthers) {
  const Comm comm(MPI_COMM_WORLD);
  const auto before = comm.traffic();

  comm.sparse_exchange(std::vector<Outgoing<std::int64_t>>{{(comm.rank() + 1) % comm.size(), {1, 2, 3}}});

  const bool to_another = comm.size() > 1;
  EXPECT_EQ(comm.traffic().messages - before.messages, to_another ? 1 : 0);
  EXPECT_EQ(comm.traffic().bytes - before.bytes, to_another ? 24 : 0);
  EXPECT_EQ(comm.traffic().bytes_received - before.bytes_received, to_another ? 24 : 0);
  EXPECT_EQ(comm.traffic().rounds - before.rounds, 1);
  EXPECT_EQ(comm.traffic().reductions - before.reductions, 1);
}

TEST(NeighborExchange, CountsWhatItSendsToOthers) {
  const Comm comm(MPI_COMM_WORLD);
  const auto before = comm.traffic();
  std::vector<Rank> others;
  for (Rank r = 0; r < comm.size(); ++r)
    if (r != comm.rank()) others.push_back(r);
  const std::vector<std::byte> mine(5);
  std::vector<std::vector<std::byte>> theirs(others.size(), std::vector<std::byte>(5));

  comm.neighbor_exchange(others, std::vector<std::span<const std::byte>>(others.size(), mine),
                         std::vector<std::span<std::byte>>(theirs.begin(), theirs.end()));

  const auto spent = comm.traffic() - before;
  EXPECT_EQ(spent.messages, comm.size() - 1);
  EXPECT_EQ(spent.bytes, 5 * (comm.size() - 1));
  EXPECT_EQ(spent.bytes_received, 5 * (comm.size() - 1));
  EXPECT_EQ(spent.rounds, 1);
  EXPECT_EQ(spent.reductions, 0);
}

TEST(Traffic, CountsOperationsOfAllRanksTogether) {
  const Comm comm(MPI_COMM_WORLD);
  const auto before = comm.traffic();

  comm.sum(1);
  comm.any(false);
  comm.exclusive_sum(2);
  comm.all_gather(1.0);
  comm.barrier();

  EXPECT_EQ((comm.traffic() - before).reductions, 5);
  EXPECT_EQ((comm.traffic() - before).rounds, 0);
}

TEST(Traffic, TellsWaitingFromWork) {
  const Comm comm(MPI_COMM_WORLD);
  const auto before = comm.traffic();
  const double wall = wall_seconds(), cpu = cpu_seconds();

  if (comm.is_first())  // the others wait for it
    while (wall_seconds() - wall < 0.05) {
    }
  comm.barrier();

  const auto spent = comm.traffic() - before;
  EXPECT_GT(spent.wait_wall, 0);
  EXPECT_LE(spent.wait_wall, wall_seconds() - wall);
  EXPECT_LE(spent.wait_cpu, cpu_seconds() - cpu);
}

TEST(Waiting, LeavesOutItsPauses) {
  const Comm comm(MPI_COMM_WORLD);
  const double start = wall_seconds();
  double paused = 0;

  {
    Comm::Waiting waiting(comm);
    waiting.pause();
    const double begin = wall_seconds();
    while (wall_seconds() - begin < 0.02) {
    }
    paused = wall_seconds() - begin;
    waiting.resume();
  }

  EXPECT_LE(comm.traffic().wait_wall, wall_seconds() - start - paused);
}

TEST(Mailbox, DeliversToEachRankInOrderAndIsEmptyAfterwards) {
  const Comm comm(MPI_COMM_WORLD);
  Mailbox<int> box(comm);
  const Rank next = (comm.rank() + 1) % comm.size(), previous = (comm.rank() + comm.size() - 1) % comm.size();

  box.add(next, 10 * comm.rank() + 1);
  box.add(next, 10 * comm.rank() + 2);
  const auto first = box.send();
  box.add(comm.rank(), 7);
  const auto second = box.send();

  EXPECT_THAT(first.rank, ElementsAre(previous));
  EXPECT_THAT(first.item, ElementsAre(10 * previous + 1, 10 * previous + 2));
  EXPECT_THAT(second.rank, ElementsAre(comm.rank()));
  EXPECT_THAT(second.item, ElementsAre(7));
}

TEST(SparseExchange, RefusesARankThatDoesNotExist) {
  const Comm comm(MPI_COMM_WORLD);

  EXPECT_THROW(comm.sparse_exchange(std::vector<Outgoing<int>>{{comm.size(), {1}}}), ContractViolation);
}

TEST(Agree, PassesSilenceThrough) {
  const Comm comm(MPI_COMM_WORLD);
  int calls = 0;

  EXPECT_NO_THROW(agree(comm, [&] { ++calls; }));

  EXPECT_EQ(calls, 1);
}

TEST(Agree, ThrowsTheSameErrorOnEveryRank) {
  const Comm comm(MPI_COMM_WORLD);
  const Rank last = comm.size() - 1;

  try {
    agree(comm, [&] {
      if (comm.rank() == last) throw Error("trouble on rank " + std::to_string(comm.rank()));
    });
    FAIL() << "expected an Error";
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), "trouble on rank " + std::to_string(last));
  }
}

TEST(Agree, TakesTheErrorOfTheLowestRank) {
  const Comm comm(MPI_COMM_WORLD);
  const Rank lowest = comm.size() / 2;

  try {
    agree(comm, [&] {
      if (comm.rank() >= lowest) throw Error("trouble on rank " + std::to_string(comm.rank()));
    });
    FAIL() << "expected an Error";
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), "trouble on rank " + std::to_string(lowest));
  }
}

TEST(BlockRange, CoversTheItemsInOrderAndEvenly) {
  for (const GlobalId n : {GlobalId{0}, GlobalId{1}, GlobalId{3}, GlobalId{7}, GlobalId{100}, GlobalId{1} << 33U})
    for (Rank size = 1; size <= 8; ++size) {
      GlobalId next = 0;
      for (Rank r = 0; r < size; ++r) {
        const auto range = block_range(n, r, size);
        EXPECT_EQ(range.begin, next);
        EXPECT_GE(range.count(), n / size);
        EXPECT_LE(range.count(), n / size + 1);
        next = range.end;
      }
      EXPECT_EQ(next, n);
    }
}

TEST(BlockOf, IsTheBlockWhoseRangeHoldsTheItem) {
  for (const GlobalId n : {GlobalId{1}, GlobalId{3}, GlobalId{7}, GlobalId{29}})
    for (Rank size = 1; size <= 8; ++size)
      for (GlobalId id = 0; id < n; ++id) {
        const auto range = block_range(n, block_of(id, n, size), size);
        EXPECT_LE(range.begin, id);
        EXPECT_LT(id, range.end);
      }
}

TEST(BlockOf, RefusesItemsThatDoNotExist) {
  EXPECT_THROW(block_of(-1, 5, 2), ContractViolation);
  EXPECT_THROW(block_of(5, 5, 2), ContractViolation);
}

}  // namespace comm_test
}  // namespace pamr::par
