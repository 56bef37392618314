// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/timer.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace pamr {
namespace {

TEST(Clocks, NeverRunBackwards) {
  const double wall = wall_seconds(), cpu = cpu_seconds();

  EXPECT_GE(wall_seconds(), wall);
  EXPECT_GE(cpu_seconds(), cpu);
}

TEST(PeakResidentBytes, GrowsByWhatIsTouched) {
  const auto before = peak_resident_bytes();
  constexpr std::size_t much = std::size_t{256} << 20U;

  const std::vector<char> memory(before + much, 'x');  // more than was ever held: the peak must rise

  EXPECT_GE(peak_resident_bytes(), before + much / 2);
  EXPECT_EQ(memory.back(), 'x');
}

TEST(StepTimer, LeavesNoGapBetweenSteps) {
  const double start = wall_seconds();
  StepTimer timer;

  timer.lap("read");
  timer.lap("close");
  timer.lap("read");

  const double whole = wall_seconds() - start;
  ASSERT_EQ(timer.steps().size(), 2U);
  EXPECT_EQ(timer.steps()[0].step, "read");
  EXPECT_EQ(timer.steps()[1].step, "close");
  const double sum = timer.steps()[0].wall + timer.steps()[1].wall;
  EXPECT_GE(sum, 0);
  EXPECT_LE(sum, whole);
}

TEST(StepTimer, LeavesOutWhatIsSkipped) {
  const double start = wall_seconds();
  StepTimer timer;
  const double before = wall_seconds();
  while (wall_seconds() - before < 0.02) {
  }
  const double skipped = wall_seconds() - before;

  timer.skip();
  timer.lap("close");

  EXPECT_LE(timer.steps().front().wall, wall_seconds() - start - skipped);
}

TEST(MergeSteps, KeepsTheOrderAndAddsEqualNames) {
  const auto merged = merge_steps({{"read", 1, 2}, {"close", 3, 4}}, {{"write", 5, 6}, {"close", 7, 8}});

  ASSERT_EQ(merged.size(), 3U);
  EXPECT_EQ(merged[0].step, "read");
  EXPECT_EQ(merged[1].step, "close");
  EXPECT_DOUBLE_EQ(merged[1].wall, 10);
  EXPECT_DOUBLE_EQ(merged[1].cpu, 12);
  EXPECT_EQ(merged[2].step, "write");
}

}  // namespace
}  // namespace pamr
