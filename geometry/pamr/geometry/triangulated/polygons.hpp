// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::geometry {

/// Faces of three corners and more, as files have them; they become triangles when all points are known.
class Polygons {
 public:
  static constexpr int min_corners = 3, max_corners = 1000;

  void add_corner(int point) { corner_.push_back(point); }
  void end_face() { end_.push_back(corner_.size()); }

  /// Appends the triangles of all faces, in order. A face of more than three corners is cut along diagonals: the
  /// shortest one that cuts off a corner to the inside, seen along the mean normal, until three corners are left. Pre:
  /// numbers of points in range. Cost: at most the cube of the corners of a face.
  void split(Triangulation& surface) const;

 private:
  std::vector<int> corner_;
  std::vector<std::size_t> end_;  // of each face, in `corner_`
};

}  // namespace pamr::geometry
