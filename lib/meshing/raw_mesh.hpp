// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pamr/geometry/tet_shape.hpp"
#include "pamr/geometry/vec3.hpp"

namespace pamr::meshing {

/// A face of the boundary, or between two regions seen from either: the one opposite corner `slot` of `cell`, on piece
/// `piece` of the domain.
struct BoundaryFace {
  std::int32_t cell = 0;
  int slot = 0;
  int piece = 0;
};

/// What a node may move on.
enum class Freedom : std::uint8_t { space, piece, curve, none };

/// Freedom of a node and the number of the piece or curve of the domain that holds it.
struct Binding {
  Freedom freedom = Freedom::space;
  int number = -1;
};

/// The mesh of one process, while it is made: no neighbors, no order.
struct RawMesh {
  std::vector<geometry::Vec3> point;              ///< n_nodes
  std::vector<Binding> binding;                   ///< n_nodes
  std::vector<std::array<std::int32_t, 4>> cell;  ///< n_cells x 4 nodes
  std::vector<BoundaryFace> face;                 ///< the faces with a cell on one side only
  std::vector<int> region;                        ///< n_cells, in `Domain::regions`; empty: there are none
  std::vector<BoundaryFace> between;              ///< the faces between two regions, each from one side

  geometry::Vec3 position(std::int32_t node) const { return point[static_cast<std::size_t>(node)]; }
  geometry::TetPoints points(std::size_t c) const {
    return {position(cell[c][0]), position(cell[c][1]), position(cell[c][2]), position(cell[c][3])};
  }
};

}  // namespace pamr::meshing
