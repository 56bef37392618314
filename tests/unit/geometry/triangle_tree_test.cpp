// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/triangle_tree.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include "pamr/base/index.hpp"

namespace triangle_tree_test {

namespace {

using pamr::at;
using pamr::geometry::TriangleTree;
using pamr::geometry::Vec3;
using Triangles = std::vector<std::array<Vec3, 3>>;

/// The face of a plate about a hole, as CAD kernels divide it, and a sheet of a few triangles above it.
Triangles plate_with_hole() {
  Triangles triangles;
  constexpr int n = 200;
  const auto on_hole = [](int i) {
    const double angle = 2 * std::numbers::pi * i / n;
    return Vec3{std::cos(angle), std::sin(angle), 0};
  };
  const std::array<Vec3, 4> corner{{{10, 10, 0}, {-10, 10, 0}, {-10, -10, 0}, {10, -10, 0}}};
  for (int i = 0; i < n; ++i) triangles.push_back({on_hole(i), corner[at(4 * i / n)], on_hole(i + 1)});
  for (int k = 0; k < 4; ++k) triangles.push_back({corner[at(k)], corner[at((k + 1) % 4)], on_hole(n * (k + 1) / 4)});
  triangles.push_back({{{-10, -10, 1}, {10, -10, 1}, {0, 10, 1}}});
  triangles.push_back({{{3, 3, 0.5}, {3, 3, 0.5}, {3, 4, 0.5}}});  // a segment
  return triangles;
}

/// The expected answer of the tree, by a search through all triangles.
TriangleTree::Hit nearest_of_all(const Triangles& triangles, Vec3 point) {
  TriangleTree::Hit best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vec3 ab = triangles[t][1] - triangles[t][0], ac = triangles[t][2] - triangles[t][0];
    const Vec3 ap = point - triangles[t][0];
    const auto [u, v] = pamr::geometry::nearest_parameters(ab, ac, ap);
    const double distance = squared_norm(ap - u * ab - v * ac);
    if (distance < least) {
      least = distance;
      best = {static_cast<int>(t), u, v};
    }
  }
  return best;
}

}  // namespace

TEST(TriangleTree, FindsTheNearestOfLongTrianglesBitForBit) {
  const auto triangles = plate_with_hole();
  const TriangleTree tree(triangles);

  for (int i = 0; i < 4000; ++i) {
    const auto part = [&](double step) { return std::fmod(i * step, 1.0); };
    const Vec3 point{24 * part(0.7548776662) - 12, 24 * part(0.5698402910) - 12, 3 * part(0.4142135624) - 1};
    const auto found = tree.nearest(point), expected = nearest_of_all(triangles, point);

    ASSERT_EQ(found.triangle, expected.triangle) << i;
    ASSERT_EQ(found.u, expected.u) << i;
    ASSERT_EQ(found.v, expected.v) << i;
  }
}

}  // namespace triangle_tree_test
