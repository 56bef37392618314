// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/sum_at_items.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "pamr/par/reproducible_sum.hpp"
#include "support/dice.hpp"

namespace pamr::par {
namespace sum_at_items_test {

struct Term {
  LocalId item = 0;
  double value = 0;
};

/// Terms of `n_items` items, from 1e-9 to 1e9 and of both signs.
std::vector<Term> random_terms(std::uint64_t seed, std::size_t n_items) {
  test::Dice dice(seed);
  std::vector<Term> terms(40 * n_items);
  for (auto& t : terms)
    t = {static_cast<LocalId>(dice.below(n_items)), dice.symmetric() * std::pow(10, 9 * dice.symmetric())};
  return terms;
}

/// All ranks hold all items.
Pattern shared_by_all(const Comm& comm, std::size_t n_items) {
  Pattern pattern;
  for (Rank rank = 0; rank < comm.size(); ++rank) {
    if (rank == comm.rank()) continue;
    pattern.rank.push_back(rank);
    for (std::size_t i = 0; i < n_items; ++i) pattern.item.push_back(static_cast<LocalId>(i));
    pattern.offset.push_back(pattern.item.size());
  }
  return pattern;
}

std::vector<std::array<double, 2>> sums_of(const Comm& comm, std::size_t n_items, const std::vector<Term>& terms) {
  const auto pattern = shared_by_all(comm, n_items);
  return sum_at_items<2>(Exchange(comm, pattern), n_items, [&](const auto& add) {
    for (const auto& t : terms) add(t.item, {t.value, 1});
  });
}

TEST(SumAtItems, HasTheSameBitsForAnyOrderAndPartition) {
  const Comm self(MPI_COMM_SELF), world(MPI_COMM_WORLD);
  constexpr std::size_t n_items = 20;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    auto terms = random_terms(seed, n_items);
    const auto expected = sums_of(self, n_items, terms);
    test::Dice dice(seed);
    dice.shuffle(terms);
    std::vector<Term> mine;
    for (const auto& t : terms)
      if (dice.below(static_cast<std::size_t>(world.size())) == static_cast<std::size_t>(world.rank()))
        mine.push_back(t);

    EXPECT_EQ(sums_of(world, n_items, mine), expected);
  }
}

TEST(SumAtItems, KeepsFourteenDigitsOfTheLargestTerm) {
  const Comm self(MPI_COMM_SELF);
  constexpr std::size_t n_items = 20;
  const auto terms = random_terms(4, n_items);

  const auto sum = sums_of(self, n_items, terms);

  std::vector<ExactSum> exact(n_items);
  std::vector<double> largest(n_items, 0), n_terms(n_items, 0);
  for (const auto& t : terms) {
    exact[at(t.item)].add(t.value);
    largest[at(t.item)] = std::max(largest[at(t.item)], std::abs(t.value));
    n_terms[at(t.item)] += 1;
  }
  for (std::size_t i = 0; i < n_items; ++i) {
    EXPECT_NEAR(sum[i][0], exact[i].value(), n_terms[i] * 0x1p-48 * largest[i]);
    EXPECT_EQ(sum[i][1], n_terms[i]);
  }
}

TEST(SumAtItems, TakesTheWholeRangeOfDoubles) {
  const Comm self(MPI_COMM_SELF);
  constexpr double tiny = 0x1p-1022, huge = 0x1p1023;

  const auto sum = sums_of(self, 4, {{0, tiny}, {0, tiny}, {1, huge}, {1, -huge}, {1, huge}, {2, -0x1p-1000}});

  EXPECT_EQ(sum[0][0], 2 * tiny);
  EXPECT_EQ(sum[1][0], huge);
  EXPECT_EQ(sum[2][0], -0x1p-1000);
  EXPECT_EQ(sum[3][0], 0.0);
}

TEST(SumAtItems, IsNotANumberWhereATermIsNotFinite) {
  const Comm self(MPI_COMM_SELF);
  constexpr double infinity = std::numeric_limits<double>::infinity();

  const auto sum = sums_of(self, 3, {{0, std::nan("")}, {0, 1}, {1, -infinity}, {1, 1e300}, {2, 1}});

  EXPECT_TRUE(std::isnan(sum[0][0]));
  EXPECT_TRUE(std::isnan(sum[1][0]));
  EXPECT_EQ(sum[2][0], 1.0);
}

}  // namespace sum_at_items_test
}  // namespace pamr::par
