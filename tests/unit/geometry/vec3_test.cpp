// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/vec3.hpp"

#include <gtest/gtest.h>

namespace pamr::geometry {
namespace vec3_test {

TEST(Vec3, HasItsComponentsByAxis) {
  const Vec3 a{1, 2, 3};

  EXPECT_EQ(a[0], 1);
  EXPECT_EQ(a[1], 2);
  EXPECT_EQ(a[2], 3);
}

TEST(Vec3, LetsAComponentBeSetByAxis) {
  Vec3 a;

  for (std::size_t axis = 0; axis < 3; ++axis) a[axis] = static_cast<double>(axis) + 1;

  EXPECT_EQ(a, (Vec3{1, 2, 3}));
}

TEST(Vec3, AddsInPlaceToTheSameBitsAsOutOfPlace) {
  const Vec3 a{0.1, 1e300, -0.3}, b{0.2, 1e-300, 0.7};
  Vec3 sum = a, difference = a;

  sum += b;
  difference -= b;

  EXPECT_EQ(sum, a + b);
  EXPECT_EQ(difference, a - b);
}

TEST(Vec3, AddsItselfInPlace) {
  Vec3 a{1, 2, 3};

  a += a;
  EXPECT_EQ(a, (Vec3{2, 4, 6}));
  a -= a;
  EXPECT_EQ(a, (Vec3{}));
}

}  // namespace vec3_test
}  // namespace pamr::geometry
