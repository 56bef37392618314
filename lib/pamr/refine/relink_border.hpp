// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::refine {

/// A new face of this rank whose other side lies on another rank.
struct BorderFace {
  mesh::CellFace face;
  Rank rank = 0;
};

/// The rank on the other side of a face ghost: a neighbour slot from n_cells on.
Rank rank_of_ghost(const mesh::DistMesh& mesh, LocalId slot);

/// Fills the rank-border arrays of `fine` and the ghost slots of its cells: each rank tells its neighbours the global
/// nodes of its new border faces and the cell behind them, and both list what they share in the order of those nodes.
/// Collective: one sparse exchange; bytes and memory proportional to the rank border.
void link_border(const par::Comm& comm, const std::vector<BorderFace>& faces, mesh::DistMesh& fine);

}  // namespace pamr::refine
