// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "solvers/dsmc/kernel/random.hpp"

namespace estimate_test {

using namespace pamr::dsmc;

TEST(Estimate, IsTheMeanWithItsStandardError) {
  const auto e = estimate({1, 2, 3, 4});
  EXPECT_DOUBLE_EQ(e.value, 2.5);
  EXPECT_DOUBLE_EQ(e.error, std::sqrt(5.0 / 3 / 4));
  EXPECT_EQ(estimate({7}).error, 0);
}

TEST(Estimate, OfGroupsIsTheMeanOfAllValuesWithTheErrorOfTheGroups) {
  const auto e = estimate({1, 3, 2, 4, 5, 9}, 3);
  EXPECT_DOUBLE_EQ(e.value, 4);
  EXPECT_DOUBLE_EQ(e.error, estimate({2, 3, 7}).error);
  EXPECT_DOUBLE_EQ(estimate({1, 3, 2, 4, 5}, 2).value, 3);  // groups of 2 and 3
  EXPECT_DOUBLE_EQ(estimate({1, 3, 2, 4, 5}, 2).error, std::sqrt(2 * (4.0 + 4.0) / 25));
  EXPECT_EQ(estimate({1, 3}, 1).error, 0);
}

TEST(GroupMeans, AreOfRunsOfNeighbors) {
  EXPECT_EQ(group_means({1, 3, 2, 4, 5, 9}, 3), (std::vector<double>{2, 3, 7}));
  EXPECT_EQ(group_means({1, 3, 2, 4, 6}, 2), (std::vector<double>{2, 4}));
  EXPECT_EQ(group_means({1, 3}, 1), std::vector<double>{2});
}

TEST(GroupBlocks, MakesEveryGroupAsLongAsAPassageIfTenAre) {
  const auto expect = [](const Grouping& g, std::size_t n_groups, std::int64_t steps, bool are_independent) {
    EXPECT_EQ(g.n_groups, n_groups);
    EXPECT_EQ(g.steps, steps);
    EXPECT_EQ(g.are_independent, are_independent);
  };
  expect(group_blocks(20, 500, 328), 20, 500, true);
  expect(group_blocks(20, 165, 328), 10, 330, true);
  expect(group_blocks(21, 165, 328), 10, 330, true);
  expect(group_blocks(20, 164, 329), 10, 328, false);  // a step too short
  expect(group_blocks(20, 25, 328), 10, 50, false);
  expect(group_blocks(3, 500, 328), 3, 500, false);
  expect(group_blocks(1, 500, 328), 1, 500, false);
  expect(group_blocks(0, 500, 328), 0, 0, false);
}

TEST(Student95, HasThePublishedValues) {
  EXPECT_NEAR(student_95(2), 12.7062, 1e-4);
  EXPECT_NEAR(student_95(3), 4.30265, 1e-5);
  EXPECT_NEAR(student_95(10), 2.26216, 1e-5);
  EXPECT_NEAR(student_95(20), 2.09302, 1e-5);
  EXPECT_NEAR(student_95(1001), 1.96234, 1e-5);
  EXPECT_EQ(student_95(5000), student_95(1001));
  EXPECT_EQ(student_95(1), std::numeric_limits<double>::infinity());
}

/// Blocks that forget each other as exp(-distance / 2), eight to a passage, ten passages; the mean is 0.
std::vector<double> blocks_that_remember(std::uint64_t seed) {
  const double memory = std::exp(-0.5), fresh = std::sqrt(1 - memory * memory);
  Random random(seed, Purpose::seed, 1, 0);
  std::vector<double> values{random.normal_pair().a};
  while (values.size() < 80) values.push_back(memory * values.back() + fresh * random.normal_pair().a);
  return values;
}

TEST(Estimate, CoversTheTruthOfCorrelatedBlocksInNineteenOfTwentyRunsOnlyInGroups) {
  const double memory = std::exp(-0.5);
  double truth = 80;  // variance of the mean of 80 such blocks, in closed form
  for (int k = 1; k < 80; ++k) truth += 2 * (80 - k) * std::pow(memory, k);
  truth /= 80.0 * 80;
  const auto groups = group_blocks(80, 1, 8);
  ASSERT_EQ(groups.n_groups, 10U);
  ASSERT_TRUE(groups.are_independent);

  const int n_runs = 4000;
  double variance = 0, variance_apart = 0;
  int covered = 0, covered_apart = 0;
  for (int run = 1; run <= n_runs; ++run) {
    const auto values = blocks_that_remember(static_cast<std::uint64_t>(run));
    const auto together = estimate(values, groups.n_groups), apart = estimate(values);
    variance += together.error * together.error / n_runs;
    variance_apart += apart.error * apart.error / n_runs;
    if (std::fabs(together.value) <= student_95(10) * together.error) ++covered;
    if (std::fabs(apart.value) <= student_95(80) * apart.error) ++covered_apart;
  }

  EXPECT_NEAR(std::sqrt(variance / truth), 0.88, 0.03);        // groups still remember their neighbors a little
  EXPECT_NEAR(std::sqrt(variance_apart / truth), 0.49, 0.03);  // each block by itself: half the true error
  EXPECT_NEAR(1.0 * covered / n_runs, 0.92, 0.015);
  EXPECT_LT(1.0 * covered_apart / n_runs, 0.7);
}

}  // namespace estimate_test
