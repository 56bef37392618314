// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::surface_mesh {

/// Corners of triangle `t`.
inline std::array<geometry::Vec3, 3> corners_of(const geometry::Triangulation& surface, std::size_t t) {
  const auto& [a, b, c] = surface.triangles[t];
  return {surface.points[at(a)], surface.points[at(b)], surface.points[at(c)]};
}

/// Those of all triangles, in order.
inline std::vector<std::array<geometry::Vec3, 3>> all_corners(const geometry::Triangulation& surface) {
  std::vector<std::array<geometry::Vec3, 3>> corners;
  corners.reserve(surface.triangles.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) corners.push_back(corners_of(surface, t));
  return corners;
}

/// Smallest height of a triangle as a part of its longest edge, 0 where that has no length; 0.866 for an even one.
inline double height_ratio(const std::array<geometry::Vec3, 3>& p) {
  const double longest =
      std::sqrt(std::max({squared_norm(p[1] - p[0]), squared_norm(p[2] - p[1]), squared_norm(p[0] - p[2])}));
  constexpr double shortest_length = 1e-140;  // its square underflows below
  if (!(longest > shortest_length)) return 0;
  return norm(cross((1 / longest) * (p[1] - p[0]), (1 / longest) * (p[2] - p[0])));
}

/// Whether the geometry (`require_valid`) refuses it as one without area.
inline bool is_flat(const std::array<geometry::Vec3, 3>& p) {
  constexpr double min_height = 1e-10;
  return !(height_ratio(p) > min_height);
}

}  // namespace pamr::surface_mesh
