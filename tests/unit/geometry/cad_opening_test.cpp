// SPDX-License-Identifier: GPL-3.0-or-later
// A face with an opening on one side: data/pipe_tee.step is a pipe of radius 1 along the x axis from -4 to 4 with a
// branch of radius 0.6 along the z axis up to 3. Its first face is the wall of the pipe, open where the branch begins.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/geometry/cad/cad_surface.hpp"

namespace pamr::geometry {
namespace cad_opening_test {

constexpr double branch = 0.6, half_length = 4;
const double pi = std::acos(-1.0);

CadSurface pipe() {
  static const auto model = make_cad_model(read_cad_source(std::string(PAMR_TEST_DATA) + "/pipe_tee.step"), "mm");
  return CadSurface(model, {0});
}

bool is_in_opening(Vec3 p) { return p.z > 0 && std::hypot(p.x, p.y) < branch; }

/// Distance from the curve where the two cylinders meet, to some 1e-4.
double distance_from_rim(Vec3 p) {
  double least = 1e300;
  for (int i = 0; i < 4000; ++i) {
    const double turn = 2 * pi * i / 4000, y = branch * std::sin(turn);
    least = std::min(least, norm(p - Vec3{branch * std::cos(turn), y, std::sqrt(1 - y * y)}));
  }
  return least;
}

TEST(CadOpening, PointsOfTheWallAreTheirOwnNearestPoints) {
  const auto wall = pipe();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> along(-half_length, half_length), turn(0, 2 * pi), off(-0.2, 0.2);
  int n_open = 0, n_far_side = 0;
  for (int i = 0; i < 5000; ++i) {
    const double x = along(random), angle = turn(random), height = off(random);
    const Vec3 on{x, std::cos(angle), std::sin(angle)}, beside{x, (1 + height) * on.y, (1 + height) * on.z};
    if (is_in_opening(on)) {
      ++n_open;
      EXPECT_NEAR(wall.distance(on), distance_from_rim(on), 1e-3) << on.x << ' ' << on.y << ' ' << on.z;
      continue;
    }
    n_far_side += on.z < 0 ? 1 : 0;
    ASSERT_LT(wall.distance(on), 1e-12) << on.x << ' ' << on.y << ' ' << on.z;
    if (distance_from_rim(on) > 0.3) {
      ASSERT_LT(norm(wall.project(beside) - on), 1e-12) << on.x << ' ' << on.y << ' ' << on.z;
    }
  }
  EXPECT_GT(n_open, 50);
  EXPECT_GT(n_far_side, 2000);
}

}  // namespace cad_opening_test
}  // namespace pamr::geometry
