// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pamr/geometry/box.hpp"
#include "pamr/geometry/triangulated/triangle_tree.hpp"
#include "pamr/geometry/vec3.hpp"

namespace pamr::meshing {

/// A closed surface of triangles that knows its inside.
class ClosedTriangles {
 public:
  /// `corner`: entries of `point`, of each triangle counter-clockwise seen from outside.
  ClosedTriangles(std::span<const geometry::Vec3> point, std::span<const std::array<int, 3>> corner);

  /// Edges without a second triangle in the other direction: the surface is open there, and sides mean nothing.
  std::int64_t n_open() const { return n_open_; }
  int open_triangle() const { return open_triangle_; }       ///< the first at such an edge
  geometry::Vec3 open_point() const { return open_point_; }  ///< an end of that edge

  /// Negative inside.
  double signed_distance(geometry::Vec3 point) const;
  int nearest(geometry::Vec3 point) const { return tree_->nearest(point).triangle; }
  const geometry::Box& box() const { return box_; }

 private:
  void add_normals();

  std::vector<geometry::Vec3> point_;
  std::vector<std::array<int, 3>> corner_;
  std::vector<geometry::Vec3> normal_, vertex_normal_;      ///< of triangles and of points, weighed by angles
  std::vector<std::array<geometry::Vec3, 3>> side_normal_;  ///< of the side opposite a corner; sums, not of length 1
  std::unique_ptr<const geometry::TriangleTree> tree_;
  geometry::Box box_;
  std::int64_t n_open_ = 0;
  int open_triangle_ = 0;
  geometry::Vec3 open_point_;
};

}  // namespace pamr::meshing
