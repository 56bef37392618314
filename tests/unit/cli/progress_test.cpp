// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/progress.hpp"

#include <gtest/gtest.h>

namespace pamr::cli {
namespace progress_test {

TEST(ProgressText, SaysHowMuchIsDoneAtWhichRateAndWhatIsLeft) {
  EXPECT_EQ(progress_text({"refining", "steps", 100}, 40, 2.0, "close"),
            "refining: 40 of 100 steps (40 %), 20 steps/s, 0:03 left, close");
}

TEST(ProgressText, GivesNoRateBeforeAnythingIsDone) {
  EXPECT_EQ(progress_text({"reading", "blocks", 10}, 0, 1.0), "reading: 0 of 10 blocks (0 %)");
}

TEST(ProgressText, ShortensLargeRatesAndLongTimes) {
  EXPECT_EQ(progress_text({"moving", "cells", 10000000000}, 5000000, 1.0),
            "moving: 5000000 of 10000000000 cells (0 %), 5 M cells/s, 33:19 left");
  EXPECT_EQ(progress_text({"moving", "cells", 7201}, 1, 1.0), "moving: 1 of 7201 cells (0 %), 1 cells/s, 2:00:00 left");
}

TEST(ProgressText, KnowsNoTimeLeftWithoutATotal) {
  EXPECT_EQ(progress_text({"waiting", "steps", -1}, 40, 2.0, "noise"), "waiting: 40 steps, 20 steps/s, noise");
}

TEST(ProgressText, CountsNoRateForWhatWasDoneBefore) {
  EXPECT_EQ(progress_text({"computing", "steps", 100, 40}, 60, 2.0),
            "computing: 60 of 100 steps (60 %), 10 steps/s, 0:04 left");
  EXPECT_EQ(progress_text({"computing", "steps", 100, 40}, 40, 2.0), "computing: 40 of 100 steps (40 %)");
}

TEST(ProgressText, SurvivesATotalOfZero) {
  EXPECT_EQ(progress_text({"refining", "cells", 0}, 0, 0.0), "refining: 0 of 0 cells");
}

TEST(Progress, IsSilentWhenNotShown) {
  testing::internal::CaptureStderr();

  Progress progress("refining", 10, "cells", false);
  progress.update(5);

  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace progress_test
}  // namespace pamr::cli
