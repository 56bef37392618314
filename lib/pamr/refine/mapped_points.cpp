// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/mapped_points.hpp"

#include <algorithm>

#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::refine {

using mesh::tet::edge_to_corner;

BaseCorners base_corners(const mesh::DistMesh& mesh, const mesh::Level0View& level0, LocalId row,
                         const std::array<LocalId, 4>& node) {
  BaseCorners corners;
  corners.row = row;
  for (std::size_t i = 0; i < 4; ++i) {
    corners.point[i] = mesh.point(node[i]);
    if (row >= 0) corners.key[i] = level0.key(node[i]);
  }
  return corners;
}

BaseCorners base_corners(const mesh::DistMesh& mesh, const mesh::Level0View& level0, LocalId cell) {
  return base_corners(mesh, level0, level0.row_of(cell), mesh.cell_to_node[at(cell)]);
}

MappedPoints::MappedPoints(const mesh::Level0View& level0, const BaseCorners& corners)
    : level0_(&level0), corners_(corners) {
  std::copy(corners.point.begin(), corners.point.end(), point_.begin());
  is_bent_ = corners.row >= 0 && std::any_of(corners.key.begin(), corners.key.end(), [&](const mesh::Level0Key& key) {
               return level0.is_bent(corners.row, key);
             });
}

mesh::Level0Key MappedPoints::key_in_middle(int edge) const {
  const auto [a, b] = edge_to_corner[at(edge)];
  return mesh::middle(corners_.key[at(a)], corners_.key[at(b)]);
}

geometry::Vec3 MappedPoints::point(int code) const {
  const int edge = code - 4;
  if (edge < 0 || (known_ >> edge & 1U) != 0) return point_[at(code)];
  known_ |= 1U << edge;
  const auto [a, b] = edge_to_corner[at(edge)];
  auto& point = point_[at(code)];
  point = geometry::midpoint(corners_.point[at(a)], corners_.point[at(b)]);
  if (is_bent_)
    if (const auto placed = level0_->place(corners_.row, key_in_middle(edge))) point = placed->point;
  return point;
}

const SplitPoints& MappedPoints::all_points() const {
  for (int code = 4; code < 10; ++code) point(code);
  return point_;
}

void MappedPoints::put(int edge, geometry::Vec3 point) {
  known_ |= 1U << edge;
  point_[at(4 + edge)] = point;
}

BaseCorners MappedPoints::child(const std::array<std::int8_t, 4>& code) const {
  BaseCorners corners;
  corners.row = corners_.row;
  for (std::size_t i = 0; i < 4; ++i) {
    corners.point[i] = point(code[i]);
    if (corners_.row >= 0) corners.key[i] = code[i] < 4 ? corners_.key[at(code[i])] : key_in_middle(code[i] - 4);
  }
  return corners;
}

}  // namespace pamr::refine
