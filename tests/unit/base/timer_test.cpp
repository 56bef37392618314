// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/timer.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace pamr {
namespace timer_test {

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

TEST(StepTimer, BooksTrafficWithTheStepInWhichItHappened) {
  Traffic so_far{.messages = 100, .bytes = 7, .wait_cpu = 1};
  StepTimer timer([&] { return so_far; });

  so_far.messages = 102;
  timer.lap("close");
  so_far.messages = 105;
  so_far.wait_cpu = 1.5;
  timer.skip();
  so_far.bytes = 17;
  so_far.rounds = 2;
  timer.lap("number");
  so_far.messages = 106;
  timer.lap("close");

  const auto& close = timer.steps()[0].traffic;
  const auto& number = timer.steps()[1].traffic;
  EXPECT_EQ(close.messages, 3);
  EXPECT_EQ(close.bytes, 0);
  EXPECT_EQ(number.messages, 0);
  EXPECT_EQ(number.bytes, 10);
  EXPECT_EQ(number.rounds, 2);
  EXPECT_EQ(close.wait_cpu + number.wait_cpu, 0);
}

TEST(StepTime, ComputesWhenItDoesNotCommunicate) {
  const StepTime step{"close", 5, 4, {.wait_wall = 3, .wait_cpu = 2.5}};

  EXPECT_EQ(step.compute(), 1.5);
}

TEST(MergeSteps, KeepsTheOrderAndAddsEqualNames) {
  const auto merged = merge_steps({{"read", 1, 2}, {"close", 3, 4, {.messages = 1}}},
                                  {{"write", 5, 6}, {"close", 7, 8, {.messages = 2}}});

  ASSERT_EQ(merged.size(), 3U);
  EXPECT_EQ(merged[0].step, "read");
  EXPECT_EQ(merged[1].step, "close");
  EXPECT_DOUBLE_EQ(merged[1].wall, 10);
  EXPECT_DOUBLE_EQ(merged[1].cpu, 12);
  EXPECT_EQ(merged[1].traffic.messages, 3);
  EXPECT_EQ(merged[2].step, "write");
}

}  // namespace timer_test
}  // namespace pamr
