// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/box.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace pamr::geometry {
namespace box_test {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<Vec3> random_points(unsigned seed, int n) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> number(-2, 3);
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) points.push_back({number(engine), number(engine), number(engine)});
  return points;
}

TEST(Box, IsEmptyAtFirst) {
  const Box box;

  EXPECT_TRUE(box.is_empty());
  EXPECT_FALSE(box.contains({0, 0, 0}));
  EXPECT_EQ(box.low, (Vec3{infinity, infinity, infinity}));
  EXPECT_EQ(box.high, (Vec3{-infinity, -infinity, -infinity}));
}

TEST(Box, OfOnePointIsThatPoint) {
  const auto box = box_of(std::vector<Vec3>{{1, -2, 3}});

  EXPECT_FALSE(box.is_empty());
  EXPECT_TRUE(box.contains({1, -2, 3}));
  EXPECT_EQ(box.center(), (Vec3{1, -2, 3}));
  EXPECT_EQ(box.diagonal(), 0);
}

TEST(Box, KnowsItsSizes) {
  const Box box{{0, -1, 2}, {2, 2, 8}};

  EXPECT_EQ(box.size(), (Vec3{2, 3, 6}));
  EXPECT_EQ(box.center(), (Vec3{1, 0.5, 5}));
  EXPECT_EQ(box.diagonal(), 7);
}

TEST(Box, HoldsItsPointsAndNoSmallerOneDoes) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto points = random_points(seed, 30);
    const auto box = box_of(points);

    for (const auto p : points) EXPECT_TRUE(box.contains(p));
    for (std::size_t k = 0; k < 3; ++k) {
      auto lower = box, higher = box;
      lower.high[k] = std::nextafter(box.high[k], -infinity);
      higher.low[k] = std::nextafter(box.low[k], infinity);
      EXPECT_FALSE(std::all_of(points.begin(), points.end(), [&](Vec3 p) { return lower.contains(p); }));
      EXPECT_FALSE(std::all_of(points.begin(), points.end(), [&](Vec3 p) { return higher.contains(p); }));
    }
  }
}

TEST(Box, OfTwoPartsIsTheirsMerged) {
  const auto a = random_points(1, 10), b = random_points(2, 10);
  auto all = a;
  all.insert(all.end(), b.begin(), b.end());

  auto merged = box_of(a);
  merged.merge(box_of(b));
  merged.merge({});

  EXPECT_EQ(merged.low, box_of(all).low);
  EXPECT_EQ(merged.high, box_of(all).high);
}

TEST(Box, IsAsFarAsItsNearestPoint) {
  const Box box{{-1, 0, 1}, {1, 2, 1.5}};
  for (const auto p : random_points(3, 200)) {
    const Vec3 nearest{std::clamp(p.x, -1.0, 1.0), std::clamp(p.y, 0.0, 2.0), std::clamp(p.z, 1.0, 1.5)};
    EXPECT_EQ(box.squared_distance(p), squared_norm(p - nearest));
    EXPECT_EQ(box.squared_distance(p) == 0, box.contains(p));
  }
}

TEST(Box, IgnoresACoordinateThatIsNoNumber) {
  Box box{{0, 0, 0}, {1, 1, 1}};

  box.extend({std::nan(""), 2, std::nan("")});

  EXPECT_EQ(box.low, (Vec3{0, 0, 0}));
  EXPECT_EQ(box.high, (Vec3{1, 2, 1}));
  EXPECT_FALSE(box.contains({std::nan(""), 0, 0}));
}

}  // namespace box_test
}  // namespace pamr::geometry
