// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::mesh {

/// A face whose other cell is on another rank.
struct RemoteFace {
  CellFace face;
  Rank rank = 0;
  GlobalId other = 0;  ///< that cell
};

/// Fills the rank-border arrays of a mesh and the neighbor slots of these faces, in an order that the other sides find
/// as well when they have the same faces. The arrays are empty before; cells and nodes are there. `here`: this rank.
/// Local.
void fill_border(Rank here, DistMesh& mesh, const std::vector<RemoteFace>& remote);

}  // namespace pamr::mesh
