// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/mapped_points.hpp"

#include <algorithm>

#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::refine {

BaseCorners MappedPoints::child(const std::array<std::int8_t, 4>& code) const {
  BaseCorners corners;
  corners.row = row;
  for (std::size_t i = 0; i < 4; ++i) {
    corners.point[i] = point[at(code[i])];
    if (row >= 0) corners.key[i] = key[at(code[i])];
  }
  return corners;
}

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

MappedPoints map_middles(const mesh::Level0View& level0, const BaseCorners& corners) {
  MappedPoints mapped;
  mapped.row = corners.row;
  std::copy(corners.point.begin(), corners.point.end(), mapped.point.begin());
  if (corners.row >= 0) std::copy(corners.key.begin(), corners.key.end(), mapped.key.begin());
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = mesh::tet::edge_to_corner[e];
    auto& point = mapped.point[4 + e];
    point = geometry::midpoint(corners.point[at(a)], corners.point[at(b)]);
    if (corners.row < 0) continue;
    mapped.key[4 + e] = mesh::middle(corners.key[at(a)], corners.key[at(b)]);
    if (const auto placed = level0.place(corners.row, mapped.key[4 + e])) {
      point = placed->point;
      mapped.is_bent = true;
    }
  }
  return mapped;
}

}  // namespace pamr::refine
