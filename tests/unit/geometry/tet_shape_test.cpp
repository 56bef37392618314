// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/tet_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace pamr::geometry {
namespace tet_shape_test {

constexpr TetPoints regular = {{{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}}};
constexpr TetPoints corner = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
constexpr TetPoints flat = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};

TetPoints mirrored(const TetPoints& p) { return {p[1], p[0], p[2], p[3]}; }

TetPoints random_tet(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  TetPoints p;
  for (Vec3& point : p) point = {unit(random), unit(random), unit(random)};
  return p;
}

TEST(Quality, IsOneForTheRegularTetrahedron) {
  EXPECT_NEAR(volume(regular), 8.0 / 3.0, 1e-15);
  EXPECT_NEAR(mean_ratio(regular), 1.0, 1e-15);
  EXPECT_NEAR(radius_ratio(regular), 1.0, 1e-15);
  EXPECT_NEAR(aspect_ratio(regular), 1.0, 1e-15);
  EXPECT_NEAR(edge_ratio(regular), 1.0, 1e-15);
  const double expected = std::acos(1.0 / 3.0) * 180.0 / std::numbers::pi;
  EXPECT_NEAR(dihedral_angles(regular).min, expected, 1e-13);
  EXPECT_NEAR(dihedral_angles(regular).max, expected, 1e-13);
}

TEST(Quality, HasTheHandComputedValuesOfACubeCorner) {
  // V = 1/6, squared edges 3 * 1 + 3 * 2, r_in = 1 / (3 + sqrt 3), R_circ = sqrt(3) / 2.
  EXPECT_NEAR(volume(corner), 1.0 / 6.0, 1e-16);
  EXPECT_NEAR(mean_ratio(corner), 12.0 * std::cbrt(0.25) / 9.0, 1e-15);
  EXPECT_NEAR(radius_ratio(corner), 3.0 / (3.0 + std::sqrt(3.0)) / (std::sqrt(3.0) / 2.0), 1e-15);
  EXPECT_NEAR(aspect_ratio(corner), std::sqrt(2.0) * (3.0 + std::sqrt(3.0)) / (2.0 * std::sqrt(6.0)), 1e-15);
  EXPECT_NEAR(edge_ratio(corner), std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(dihedral_angles(corner).min, std::atan(std::sqrt(2.0)) * 180.0 / std::numbers::pi, 1e-13);
  EXPECT_NEAR(dihedral_angles(corner).max, 90.0, 1e-13);
}

TEST(Quality, HasTheKnownRadiusRatioOfKuhnCells) {
  const TetPoints kuhn = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}}};
  // V = 1/6, areas 1/2, 1/2, sqrt(2)/2, sqrt(2)/2; the circumscribed sphere is the cube's.
  const double inner = 0.5 / (1.0 + std::sqrt(2.0)), outer = std::sqrt(3.0) / 2.0;
  EXPECT_NEAR(radius_ratio(kuhn), 3.0 * inner / outer, 1e-15);
  EXPECT_NEAR(radius_ratio(kuhn), 0.717, 5e-4);
  EXPECT_NEAR(dihedral_angles(kuhn).min, 45.0, 1e-13);
  EXPECT_NEAR(dihedral_angles(kuhn).max, 90.0, 1e-13);
}

TEST(Quality, KeepsTheSignOfTheVolumeInTheMeanRatioOnly) {
  EXPECT_EQ(mean_ratio(mirrored(corner)), -mean_ratio(corner));
  EXPECT_LT(volume(mirrored(corner)), 0);
  EXPECT_NEAR(radius_ratio(mirrored(corner)), radius_ratio(corner), 1e-15);
  EXPECT_NEAR(aspect_ratio(mirrored(corner)), aspect_ratio(corner), 1e-15);
  EXPECT_NEAR(dihedral_angles(mirrored(corner)).max, 90.0, 1e-13);
}

TEST(Quality, IsWorstAndFiniteOrInfiniteButNeverNanForDegenerateCells) {
  EXPECT_EQ(mean_ratio(flat), 0);
  EXPECT_EQ(radius_ratio(flat), 0);
  EXPECT_EQ(aspect_ratio(flat), std::numeric_limits<double>::infinity());
  EXPECT_EQ(dihedral_angles(flat).min, 0);
  EXPECT_EQ(dihedral_angles(flat).max, 180);

  const TetPoints point = {};
  EXPECT_EQ(mean_ratio(point), 0);
  EXPECT_EQ(radius_ratio(point), 0);
  EXPECT_EQ(aspect_ratio(point), std::numeric_limits<double>::infinity());
  EXPECT_EQ(edge_ratio(point), std::numeric_limits<double>::infinity());
  EXPECT_FALSE(std::isnan(dihedral_angles(point).min));
  EXPECT_FALSE(std::isnan(dihedral_angles(point).max));
}

TEST(Quality, DoesNotDependOnSizeOrOrderOfCorners) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 500; ++trial) {
    const TetPoints p = random_tet(random);
    TetPoints scaled = p;
    for (Vec3& point : scaled) point = 0x1p-100 * point;
    const TetPoints turned = {p[2], p[0], p[1], p[3]};

    for (const auto& metric : {mean_ratio, radius_ratio, aspect_ratio, edge_ratio}) {
      const double value = metric(p);
      ASSERT_NEAR(metric(scaled), value, 1e-14 * std::abs(value));
      ASSERT_NEAR(metric(turned), value, 1e-10 * std::abs(value));
    }
  }
}

TEST(Quality, AgreesWithDihedralAnglesTakenOneByOne) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 500; ++trial) {
    const TetPoints p = random_tet(random);
    double least = 180, greatest = 0;
    constexpr std::array<std::array<std::size_t, 4>, 6> edges = {
        {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}}};
    for (const auto& [a, b, c, d] : edges) {
      // The angle between the parts of the two other corners' directions that stand square to the edge.
      const Vec3 axis = (1.0 / norm(p[b] - p[a])) * (p[b] - p[a]);
      const auto square = [&](Vec3 v) { return v - dot(v, axis) * axis; };
      const Vec3 left = square(p[c] - p[a]), right = square(p[d] - p[a]);
      const double angle = std::acos(std::clamp(dot(left, right) / (norm(left) * norm(right)), -1.0, 1.0));
      least = std::min(least, angle * 180.0 / std::numbers::pi);
      greatest = std::max(greatest, angle * 180.0 / std::numbers::pi);
    }
    ASSERT_NEAR(dihedral_angles(p).min, least, 1e-5);
    ASSERT_NEAR(dihedral_angles(p).max, greatest, 1e-5);
  }
}

}  // namespace tet_shape_test
}  // namespace pamr::geometry
