// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/crossing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "pamr/geometry/vec3.hpp"

namespace pamr::meshing {
namespace {

using geometry::Vec3;

/// A ball, region 0, about a smaller one off its middle, region 1; outside -1.
constexpr Vec3 middle{0.2, 0, 0};
constexpr double outer = 1, inner = 0.4;

int region_at(Vec3 p) { return norm(p) >= outer ? -1 : norm(p - middle) >= inner ? 0 : 1; }

Domain::Ball ball_about(Vec3 p) {
  const double clear = std::min(std::abs(norm(p) - outer), std::abs(norm(p - middle) - inner));
  return {region_at(p), (1 - 1e-9) * clear, p};
}

/// Bisection that asks for every middle.
Crossing plain(std::array<Vec3, 2> end, std::array<int, 2> region, double squared_error) {
  Crossing result{geometry::midpoint(end[0], end[1]), end, region};
  while (squared_norm(result.end[1] - result.end[0]) >= squared_error) {
    const int here = region_at(result.point);
    const std::size_t side = here == result.region[0] ? 0 : 1;
    result.end[side] = result.point;
    result.region[side] = here;
    result.point = geometry::midpoint(result.end[0], result.end[1]);
  }
  return result;
}

TEST(Crossing, IsThatOfPlainBisectionFromFewerQuestions) {
  constexpr double error = 1e-12;
  std::mt19937_64 dice(7);
  std::uniform_real_distribution<double> coordinate(-1.5, 1.5);
  const auto point = [&] { return Vec3{coordinate(dice), coordinate(dice), coordinate(dice)}; };
  std::int64_t n_ways = 0, n_asked = 0, n_middles = 0;
  for (int i = 0; i < 10'000; ++i) {
    const std::array<Vec3, 2> end{point(), point()};
    const std::array<int, 2> region{region_at(end[0]), region_at(end[1])};
    if (region[0] == region[1]) continue;
    ++n_ways;
    const auto ask = [&](Vec3 p) {
      ++n_asked;
      return ball_about(p);
    };
    const auto found = find_crossing(end, region, error, ask, [&](Vec3) { ++n_middles; });
    const auto expected = plain(end, region, error);
    ASSERT_EQ(found.point, expected.point) << i;
    ASSERT_EQ(found.end, expected.end) << i;
    ASSERT_EQ(found.region, expected.region) << i;
  }
  EXPECT_GT(n_ways, 2000);
  EXPECT_GT(n_middles, 18 * n_ways);
  EXPECT_LT(3 * n_asked, 2 * n_middles);
}

TEST(Crossing, WithoutKnownDistancesIsThatOfPlainBisection) {
  const std::array<Vec3, 2> end{Vec3{-1.2, 0.1, 0.05}, Vec3{0.25, 0, 0}};
  const std::array<int, 2> region{-1, 1};
  const auto found = find_crossing(
      end, region, 1e-12, [](Vec3 p) { return Domain::Ball{region_at(p)}; }, [](Vec3) {});
  const auto expected = plain(end, region, 1e-12);
  EXPECT_EQ(found.point, expected.point);
  EXPECT_EQ(found.region, (std::array{-1, 0}));
}

}  // namespace
}  // namespace pamr::meshing
