// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/refine/diagonal.hpp"

namespace pamr::refine {

/// The corners of a base cell, where they lie in the domain and in level 0.
struct BaseCorners {
  geometry::TetPoints point{};
  std::array<mesh::Level0Key, 4> key{};
  LocalId row = -1;  ///< of the map; -1: the cell is not bent, and keys are not looked at
};

/// The corners of a base cell and the middles of its edges where new nodes would lie, by node code.
struct MappedPoints {
  SplitPoints point{};
  std::array<mesh::Level0Key, 10> key{};
  LocalId row = -1;
  bool is_bent = false;  ///< a middle may lie elsewhere than in the middle

  /// A child of the base cell, given by the codes of its corners.
  BaseCorners child(const std::array<std::int8_t, 4>& code) const;
};

/// The corners that these nodes are of a cell that descends from the one of a row. Local.
BaseCorners base_corners(const mesh::DistMesh& mesh, const mesh::Level0View& level0, LocalId row,
                         const std::array<LocalId, 4>& node);
/// Of a cell. Local.
BaseCorners base_corners(const mesh::DistMesh& mesh, const mesh::Level0View& level0, LocalId cell);

/// Where new nodes in the middles of the edges would lie: where the map puts them, else in the middle. Local.
MappedPoints map_middles(const mesh::Level0View& level0, const BaseCorners& corners);

}  // namespace pamr::refine
