// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/mapped_points.hpp"

#include <algorithm>
#include <bit>

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
    if (row >= 0) corners.weights[i] = level0.weights(row, node[i]);
  }
  return corners;
}

BaseCorners base_corners(const mesh::DistMesh& mesh, const mesh::Level0View& level0, LocalId cell) {
  return base_corners(mesh, level0, level0.row_of(cell), mesh.cell_to_node[at(cell)]);
}

MappedPoints::MappedPoints(const mesh::Level0View& level0, const BaseCorners& corners)
    : level0_(&level0), corners_(corners) {
  std::copy(corners.point.begin(), corners.point.end(), point_.begin());
  is_bent_ = corners.row >= 0 && std::any_of(corners.weights.begin(), corners.weights.end(),
                                             [&](const auto& weights) { return level0.is_bent(corners.row, weights); });
}

mesh::CornerWeights MappedPoints::weights_in_middle(int edge) const {
  const auto [a, b] = edge_to_corner[at(edge)];
  return mesh::middle(corners_.weights[at(a)], corners_.weights[at(b)]);
}

void MappedPoints::place(unsigned middles) const {
  for (unsigned rest = middles; rest != 0; rest &= rest - 1) {
    const int edge = std::countr_zero(rest);
    const auto [a, b] = edge_to_corner[at(edge)];
    auto& point = point_[at(4 + edge)];
    const auto placed = is_bent_ ? level0_->place(corners_.row, weights_in_middle(edge)) : std::nullopt;
    point = placed ? placed->point : geometry::midpoint(corners_.point[at(a)], corners_.point[at(b)]);
  }
  known_ |= middles;
}

SplitPoints MappedPoints::points_gone_back(EdgeMask middles) const {
  auto result = points(middles);
  for (unsigned rest = middles & ~existing_; rest != 0; rest &= rest - 1) {
    const int edge = std::countr_zero(rest);
    const auto [a, b] = edge_to_corner[at(edge)];
    result[at(4 + edge)] = geometry::midpoint(corners_.point[at(a)], corners_.point[at(b)]);
  }
  return result;
}

void MappedPoints::put(int edge, geometry::Vec3 point) {
  existing_ |= 1U << edge;
  known_ |= 1U << edge;
  point_[at(4 + edge)] = point;
}

BaseCorners MappedPoints::child(const std::array<std::int8_t, 4>& code) const {
  BaseCorners corners;
  corners.row = corners_.row;
  for (std::size_t i = 0; i < 4; ++i) {
    const int edge = code[i] - 4;
    corners.point[i] = points(edge < 0 ? EdgeMask{0} : static_cast<EdgeMask>(1U << edge))[at(code[i])];
    if (corners_.row >= 0) corners.weights[i] = edge < 0 ? corners_.weights[at(code[i])] : weights_in_middle(edge);
  }
  return corners;
}

}  // namespace pamr::refine
