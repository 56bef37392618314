// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/triangle_metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pamr::check {
namespace triangle_metrics_test {

TEST(TriangleMetrics, AreBestForEqualSides) {
  const auto [mean_ratio, aspect_ratio, min_angle, max_angle] =
      triangle_metrics({{{0, 0, 7}, {2, 0, 7}, {1, std::sqrt(3.0), 7}}});

  EXPECT_NEAR(mean_ratio, 1, 1e-14);
  EXPECT_NEAR(aspect_ratio, 1, 1e-14);
  EXPECT_NEAR(min_angle, 60, 1e-12);
  EXPECT_NEAR(max_angle, 60, 1e-12);
}

TEST(TriangleMetrics, KnowTheHalfOfASquare) {
  const auto [mean_ratio, aspect_ratio, min_angle, max_angle] = triangle_metrics({{{0, 0, 0}, {0, 3, 0}, {0, 0, 3}}});

  EXPECT_NEAR(mean_ratio, std::sqrt(3.0) / 2, 1e-14);
  EXPECT_NEAR(aspect_ratio, (1 + std::sqrt(2.0)) / std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(min_angle, 45, 1e-12);
  EXPECT_NEAR(max_angle, 90, 1e-12);
}

TEST(TriangleMetrics, AreWorstWithoutArea) {
  for (const double x : {0.0, 1.0}) {
    const auto [mean_ratio, aspect_ratio, min_angle, max_angle] = triangle_metrics({{{0, 0, 0}, {x, 0, 0}, {2, 0, 0}}});

    EXPECT_EQ(mean_ratio, 0);
    EXPECT_TRUE(std::isinf(aspect_ratio));
    EXPECT_EQ(min_angle, 0);
    EXPECT_EQ(max_angle, 180);
  }
}

}  // namespace triangle_metrics_test
}  // namespace pamr::check
