// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::geometry {

/// Removes points that no triangle uses; the others keep their order. Numbers of points must be in range.
void drop_unused_points(Triangulation& surface);

/// Throws `Error` beginning with `where` and naming the first triangle concerned (counted from 1) unless the surface is
/// one that a body may have: not empty, coordinates finite and below 1e30, numbers of points in range, three different
/// points a triangle, no triangle flatter than 1e-10 of its longest edge, at most two triangles at an edge, both in the
/// same sense, every edge closed (unless `open_allowed`), and the triangles at a point joined to one fan.
/// O(n log n).
void require_valid(const Triangulation& surface, const std::string& where, Exact<bool> open_allowed);

/// The triangle beyond edge k of each triangle, the one from corner k to corner k + 1, and which of its edges that is;
/// -1 where the surface ends. n x 3. The surface must be valid. O(n log n).
struct Beyond {
  int triangle = -1;
  int edge = -1;
};
std::vector<std::array<Beyond, 3>> triangle_neighbors(const Triangulation& surface);

}  // namespace pamr::geometry
