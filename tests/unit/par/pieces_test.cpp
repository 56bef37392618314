// SPDX-License-Identifier: GPL-3.0-or-later
// Messages longer than an MPI count go in pieces. Here pieces are tiny, so that every exchange is cut into many.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "pamr/base/contract.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::par {
namespace pieces_test {

/// A record whose size no piece divides.
struct Record {
  std::int64_t from = 0, to = 0, place = 0;
  friend bool operator==(const Record&, const Record&) = default;
};

std::uint64_t draw(std::uint64_t seed, std::int64_t a, std::int64_t b) {
  return combine(combine(mix(seed), static_cast<std::uint64_t>(a)), static_cast<std::uint64_t>(b));
}

/// Number of items from one rank to another: none, one, or up to a hundred, so that most messages take many pieces.
std::size_t length(std::uint64_t seed, Rank from, Rank to) {
  const auto word = draw(seed, from, to);
  return word % 4 == 0 ? 0 : static_cast<std::size_t>(word >> 8U) % (word % 4 == 1 ? 3U : 100U);
}

class Pieces : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(OfBytes, Pieces, testing::Values(7U, 64U, 1000U));

TEST_P(Pieces, OfASparseExchangeAreJoinedInOrder) {
  const Comm comm(MPI_COMM_WORLD, GetParam()), whole(MPI_COMM_WORLD);
  for (std::uint64_t seed = 0; seed < 4; ++seed) {  // one after the other: no piece may slip into the next exchange
    std::vector<Outgoing<Record>> messages;
    for (Rank to = comm.size(); to-- > 0;) {
      messages.push_back({to, {}});
      for (std::size_t i = 0; i < length(seed, comm.rank(), to); ++i)
        messages.back().item.push_back({comm.rank(), to, static_cast<std::int64_t>(i)});
    }

    const auto received = comm.sparse_exchange(messages);

    std::size_t n_expected = 0;
    for (Rank from = 0; from < comm.size(); ++from) n_expected += length(seed, from, comm.rank());
    EXPECT_EQ(received.item.size(), n_expected);
    for (std::size_t r = 0; r < received.rank.size(); ++r)
      for (std::size_t i = 0; i < received.from(r).size(); ++i)
        EXPECT_EQ(received.from(r)[i], (Record{received.rank[r], comm.rank(), static_cast<std::int64_t>(i)}));
    const auto expected = whole.sparse_exchange(messages);
    EXPECT_EQ(received.rank, expected.rank);
    EXPECT_EQ(received.offset, expected.offset);
    EXPECT_EQ(received.item, expected.item);
  }
}

TEST_P(Pieces, OfANeighborExchangeFillTheirPlaces) {
  const Comm comm(MPI_COMM_WORLD, GetParam());
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Pattern pattern;
    for (Rank other = 0; other < comm.size(); ++other) {
      if (other == comm.rank()) continue;
      const auto n = length(seed, std::min(other, comm.rank()), std::max(other, comm.rank()));
      pattern.rank.push_back(other);
      pattern.item.resize(pattern.item.size() + n);
      pattern.offset.push_back(pattern.item.size());
    }
    std::vector<Record> mine, expected;
    for (std::size_t r = 0; r < pattern.rank.size(); ++r)
      for (auto i = pattern.offset[r]; i < pattern.offset[r + 1]; ++i) {
        const auto place = static_cast<std::int64_t>(i - pattern.offset[r]);
        mine.push_back({comm.rank(), pattern.rank[r], place});
        expected.push_back({pattern.rank[r], comm.rank(), place});
      }

    EXPECT_EQ(Exchange(comm, pattern).swap<Record>(mine), expected);
  }
}

TEST_P(Pieces, OfABroadcastComeFromAnyRank) {
  const Comm comm(MPI_COMM_WORLD, GetParam());
  for (Rank root = 0; root < comm.size(); ++root)
    for (const std::size_t n : {0U, 1U, 5U, 333U}) {
      std::vector<Record> expected;
      for (std::size_t i = 0; i < n; ++i) expected.push_back({root, -1, static_cast<std::int64_t>(i)});

      EXPECT_EQ(comm.broadcast(comm.rank() == root ? expected : std::vector<Record>{{9, 9, 9}}, root), expected);
    }
}

TEST_P(Pieces, OfALongSumAreAddedElementByElement) {
  const Comm comm(MPI_COMM_WORLD, GetParam());
  std::vector<std::int64_t> values(301);
  std::iota(values.begin(), values.end(), std::int64_t{comm.rank()} << 40U);
  auto expected = values;
  const auto p = static_cast<std::int64_t>(comm.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    expected[i] = p * static_cast<std::int64_t>(i) + (p * (p - 1) / 2) * (std::int64_t{1} << 40U);

  comm.sum_in_place(values);

  EXPECT_EQ(values, expected);
}

TEST_P(Pieces, OfRowsReachTheirBlocksAndComeBack) {
  const Comm comm(MPI_COMM_WORLD, GetParam());
  for (const IdRange all : {IdRange(257), IdRange(257, GlobalId{1} << 33U)}) {
    std::vector<GlobalId> ids;
    for (GlobalId i = 0; i < all.n; ++i)
      if (static_cast<Rank>(draw(3, i, 0) % static_cast<std::uint64_t>(comm.size())) == comm.rank())
        ids.push_back(all.end() - 1 - i);
    std::vector<std::int64_t> rows;
    for (const auto id : ids)
      for (std::int64_t k = 0; k < 3; ++k) rows.push_back(3 * id + k);

    const auto block = scatter_rows<std::int64_t>(comm, all, rows, 3, ids);

    const auto range = block_range(all, comm.rank(), comm.size());
    std::vector<std::int64_t> expected(static_cast<std::size_t>(3 * range.count()));
    std::iota(expected.begin(), expected.end(), 3 * range.begin);
    EXPECT_EQ(block, expected);
    EXPECT_EQ(fetch_rows<std::int64_t>(comm, all, block, 3, ids), rows);
  }
}

TEST_P(Pieces, OfCardsFindTheSameSharedThings) {
  const Comm comm(MPI_COMM_WORLD, GetParam()), whole(MPI_COMM_WORLD);
  std::vector<SharedKey> key;
  for (GlobalId i = 0; i < 100; ++i)
    if (draw(7, i, comm.rank()) % 3 != 0) key.push_back({(GlobalId{1} << 33U) + i, (GlobalId{1} << 34U) - i, -1});

  const auto pattern = find_shared(comm, key), expected = find_shared(whole, key);

  EXPECT_EQ(pattern.rank, expected.rank);
  EXPECT_EQ(pattern.offset, expected.offset);
  EXPECT_EQ(pattern.item, expected.item);
}

TEST(PieceSize, IsWhatAnMpiCountCanHold) {
  EXPECT_THROW(Comm(MPI_COMM_SELF, 0), ContractViolation);
  EXPECT_THROW(Comm(MPI_COMM_SELF, std::size_t{1} << 31U), ContractViolation);
}

TEST(BlockRanges, ShareOutNumbersBeyond2To33) {
  const std::array<IdRange, 4> ranges{IdRange((GlobalId{1} << 35U) + 5), IdRange(17, GlobalId{1} << 33U),
                                      IdRange(GlobalId{6} << 33U, GlobalId{1} << 53U), IdRange(2, GlobalId{1} << 53U)};
  for (const auto all : ranges)
    for (const Rank size : {1, 2, 7, 64}) {
      GlobalId next = all.first;
      for (Rank r = 0; r < size; ++r) {
        const auto range = block_range(all, r, size);
        EXPECT_EQ(range.begin, next);
        next = range.end;
        if (range.count() == 0) continue;
        EXPECT_EQ(block_of(range.begin, all, size), r);
        EXPECT_EQ(block_of(range.end - 1, all, size), r);
      }
      EXPECT_EQ(next, all.end());
      EXPECT_THROW(block_of(all.first - 1, all, size), ContractViolation);
      EXPECT_THROW(block_of(all.end(), all, size), ContractViolation);
    }
}

}  // namespace pieces_test
}  // namespace pamr::par
