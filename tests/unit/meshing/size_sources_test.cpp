// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/size_sources.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/dice.hpp"

namespace pamr::meshing {
namespace size_sources_test {

using geometry::Vec3;

TEST(Curvature, IsThatOfTheSurfaceWhateverItsParameters) {
  test::Dice dice(4);
  const auto number = [&] { return dice.symmetric(); };
  for (int i = 0; i < 200; ++i) {
    // z = (k x^2 + l y^2) / 2 at its vertex, over parameters that are skew and not evenly spaced
    const double k = 3 * number(), l = 3 * number();
    const Vec3 u{number(), number(), 0}, v{number(), number(), 0};
    if (norm(cross(u, v)) < 0.1) continue;
    const auto second = [&](Vec3 a, Vec3 b) { return Vec3{number(), number(), k * a.x * b.x + l * a.y * b.y}; };

    EXPECT_NEAR(curvature({{}, u, v, second(u, u), second(u, v), second(v, v)}), std::max(std::abs(k), std::abs(l)),
                1e-5);
  }
  EXPECT_LT(curvature({{}, {1, 0, 0}, {2, 0, 0}, {}, {}, {}}), 0);
}

}  // namespace size_sources_test
}  // namespace pamr::meshing
