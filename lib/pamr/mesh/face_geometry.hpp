// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/tet.hpp"

/// Areas and centroids of faces, for fluxes between cells. Volumes and centroids of cells: geometry/tet_shape.hpp.
namespace pamr::mesh {

/// Corners of the face opposite corner `slot` (0 to 3), counter-clockwise seen from outside; lengths as of `cell`.
constexpr std::array<geometry::Vec3, 3> face_points(const geometry::TetPoints& cell, Exact<int> slot) {
  const auto [i, j, k] = tet::face_to_corner[static_cast<std::size_t>(int{slot})];
  return {cell[static_cast<std::size_t>(i)], cell[static_cast<std::size_t>(j)], cell[static_cast<std::size_t>(k)]};
}

/// The area of that face times its outward unit normal, in squared length units. The four sum to zero but for rounding.
constexpr geometry::Vec3 area_vector(const geometry::TetPoints& cell, Exact<int> slot) {
  const auto [a, b, c] = face_points(cell, slot);
  return 0.5 * cross(b - a, c - a);
}

/// Mean of its corners. The two cells of a face meet its corners in different orders: the last bits may differ.
constexpr geometry::Vec3 face_centroid(const geometry::TetPoints& cell, Exact<int> slot) {
  const auto [a, b, c] = face_points(cell, slot);
  return (1.0 / 3) * (a + b + c);
}

}  // namespace pamr::mesh
