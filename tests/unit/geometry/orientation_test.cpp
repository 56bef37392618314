// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/orientation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "pamr/base/error.hpp"

namespace pamr::geometry {
namespace orientation_test {

constexpr Vec3 origin{0, 0, 0}, x_unit{1, 0, 0}, y_unit{0, 1, 0}, z_unit{0, 0, 1};

/// Sign of the determinant of small integer coordinates, in exact integers.
int integer_orientation(const std::array<std::array<std::int64_t, 3>, 4>& p) {
  std::array<std::array<std::int64_t, 3>, 3> m{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) m[i][k] = p[i + 1][k] - p[0][k];
  const std::int64_t value = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return (value > 0) - (value < 0);
}

TEST(Orientation, IsPositiveForARightHandedCell) {
  EXPECT_EQ(orientation(origin, x_unit, y_unit, z_unit), 1);
  EXPECT_EQ(orientation(origin, y_unit, x_unit, z_unit), -1);
  EXPECT_TRUE(is_positive(origin, x_unit, y_unit, z_unit));
  EXPECT_FALSE(is_positive(origin, y_unit, x_unit, z_unit));
}

TEST(Orientation, IsZeroForFlatCellsOnly) {
  const double step = std::numeric_limits<double>::denorm_min();

  EXPECT_EQ(orientation(origin, x_unit, y_unit, {0.3, 0.4, 0}), 0);
  EXPECT_EQ(orientation(origin, x_unit, y_unit, {0.3, 0.4, step}), 1);
  EXPECT_EQ(orientation(origin, x_unit, y_unit, {0.3, 0.4, -step}), -1);
  EXPECT_EQ(orientation(x_unit, x_unit, y_unit, z_unit), 0);
  EXPECT_FALSE(is_positive(origin, x_unit, y_unit, {0.3, 0.4, 0}));
}

TEST(Orientation, SeesTheLastBitOfACoordinateFarFromTheOrigin) {
  // The plane x + y + z = 3 * 12345.678, a point on it and its neighbors by one unit in the last place.
  const double s = 12345.678;
  const Vec3 a{s, s, s}, b{s + 1, s - 1, s}, c{s, s + 1, s - 1};
  const Vec3 on{s + 2, s - 1, s - 1};
  const double up = std::nextafter(on.z, 1e9), down = std::nextafter(on.z, -1e9);

  const int exact = exact_orientation(a, b, c, on);
  EXPECT_EQ(orientation(a, b, c, on), exact);
  EXPECT_EQ(orientation(a, b, c, {on.x, on.y, up}), exact_orientation(a, b, c, {on.x, on.y, up}));
  EXPECT_EQ(orientation(a, b, c, {on.x, on.y, down}), exact_orientation(a, b, c, {on.x, on.y, down}));
  EXPECT_GE(orientation(a, b, c, {on.x, on.y, up}), orientation(a, b, c, {on.x, on.y, down}));
}

TEST(Orientation, AgreesWithIntegerArithmeticOnGridPoints) {
  // A small grid makes many flat cells. Its spacing of 2^-30 about the point (1024, 1024, 1024) is exact in doubles.
  std::mt19937_64 random(7);
  std::uniform_int_distribution<std::int64_t> grid(-3, 3);
  int flat = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::array<std::array<std::int64_t, 3>, 4> p{};
    std::array<Vec3, 4> q{};
    for (std::size_t i = 0; i < 4; ++i) {
      for (auto& value : p[i]) value = grid(random);
      const auto place = [](std::int64_t value) { return std::ldexp(1.0, 10) + std::ldexp(double(value), -30); };
      q[i] = {place(p[i][0]), place(p[i][1]), place(p[i][2])};
    }
    const int expected = integer_orientation(p);
    flat += expected == 0;
    ASSERT_EQ(orientation(q[0], q[1], q[2], q[3]), expected) << "trial " << trial;
  }
  EXPECT_GT(flat, 500);
}

TEST(Orientation, ChangesSignWithEveryExchangeOfTwoNearlyFlatCorners) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3 a{unit(random), unit(random), unit(random)}, b{unit(random), unit(random), unit(random)};
    const Vec3 c{unit(random), unit(random), unit(random)};
    const double s = unit(random), t = unit(random);
    const Vec3 d = a + s * (b - a) + t * (c - a);  // flat but for rounding

    const int sign = orientation(a, b, c, d);
    ASSERT_EQ(sign, exact_orientation(a, b, c, d));
    ASSERT_EQ(orientation(b, a, c, d), -sign);
    ASSERT_EQ(orientation(a, c, b, d), -sign);
    ASSERT_EQ(orientation(a, b, d, c), -sign);
    ASSERT_EQ(orientation(b, c, a, d), sign);
    ASSERT_EQ(orientation(d, c, b, a), sign);
  }
}

TEST(Orientation, SurvivesUnderflowAndOverflow) {
  for (const double scale : {1e-310, 1e-150, 1e-100, 1.0, 1e100, 1e150, 1e300}) {
    const Vec3 a{}, b{scale, 0, 0}, c{0, scale, 0}, d{0, 0, scale};
    EXPECT_EQ(orientation(a, b, c, d), 1) << scale;
    EXPECT_EQ(orientation(b, a, c, d), -1) << scale;
    EXPECT_EQ(orientation(a, b, c, {scale, scale, 0}), 0) << scale;
  }
  // Minors that underflow beside a height that is huge.
  EXPECT_EQ(orientation({0, 0, 0}, {3e-162, 1e-162, 0}, {1e-162, 3e-162, 0}, {0, 0, 1e200}), 1);
  EXPECT_EQ(orientation({0, 0, 0}, {1e-162, 3e-162, 0}, {3e-162, 1e-162, 0}, {0, 0, 1e200}), -1);
}

TEST(Orientation, RefusesCoordinatesThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

  EXPECT_THROW(orientation(origin, x_unit, y_unit, {0, 0, nan}), ContractViolation);
  EXPECT_THROW(orientation(origin, {nan, 0, 0}, y_unit, z_unit), ContractViolation);
  EXPECT_THROW(orientation(origin, x_unit, {0, infinity, 0}, z_unit), ContractViolation);
}

}  // namespace orientation_test
}  // namespace pamr::geometry
