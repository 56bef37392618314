// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/equal_work.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "pamr/base/hash.hpp"

namespace pamr {
namespace equal_work_test {

std::uint8_t weight_of(GlobalId item) {
  return static_cast<std::uint8_t>(1 + mix(static_cast<std::uint64_t>(item)) % 255);
}

TEST(EqualWork, EachItemIsInTheRunInWhichItsMiddleFallsWhoeverHoldsIt) {
  const par::Comm comm(MPI_COMM_WORLD);
  constexpr GlobalId n = 1000;
  constexpr Rank n_runs = 7;
  std::int64_t total = 0;
  for (GlobalId i = 0; i < n; ++i) total += weight_of(i);
  const auto here = par::block_range(n, comm.rank(), comm.size());
  std::vector<std::uint8_t> weight;
  for (auto i = here.begin; i < here.end; ++i) weight.push_back(weight_of(i));

  const auto run = par::runs_of_equal_work(comm, weight, n_runs);

  ASSERT_EQ(std::ssize(run), here.count());
  std::int64_t before = 0;
  for (GlobalId i = 0; i < here.end; before += weight_of(i++)) {
    if (i < here.begin) continue;
    EXPECT_EQ(run[static_cast<std::size_t>(i - here.begin)], (2 * before + weight_of(i)) * n_runs / (2 * total)) << i;
  }
}

TEST(EqualWork, ManyRunsOfFewItemsLeaveSomeEmpty) {
  const par::Comm comm(MPI_COMM_WORLD);
  const std::vector<std::int64_t> weight(comm.rank() == comm.size() - 1 ? 2 : 0, 1);  // all on the last rank

  const auto run = par::runs_of_equal_work(comm, weight, 8);

  EXPECT_EQ(run, weight.empty() ? std::vector<Rank>{} : (std::vector<Rank>{2, 6}));
}

TEST(EqualWork, CutsHugeWeightsIntoAMillionRuns) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto here = par::block_range(3, comm.rank(), comm.size());
  const std::vector<std::int64_t> weight(static_cast<std::size_t>(here.count()), std::int64_t{1} << 59U);
  const std::vector<Rank> sixths{174762, 524288, 873813};  // one, three and five of 2^20

  const auto run = par::runs_of_equal_work(comm, weight, 1 << 20);

  EXPECT_EQ(run, std::vector<Rank>(sixths.begin() + here.begin, sixths.begin() + here.end));
}

TEST(EqualWork, OfNothingThereAreNoRuns) {
  const par::Comm comm(MPI_COMM_WORLD);

  EXPECT_TRUE(par::runs_of_equal_work(comm, std::vector<std::int64_t>{}, 3).empty());
}

}  // namespace equal_work_test
}  // namespace pamr
