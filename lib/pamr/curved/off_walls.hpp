// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::curved {

/// Nodes that do not lie on the curved surfaces of their patches.
struct NodesOffWalls {
  /// For each node of this rank what the nodal field `off_surface` shall say, so that a refinement puts it onto its
  /// surfaces; empty on every rank where no node need be moved.
  std::vector<double> off;
  bool any_stays = false;  ///< on any rank: a node that is off and not to be moved unasked
};

/// A node is off if its distance from one of its curved surfaces, or what the field `off_surface` says, is more than
/// 1e-6 of the edges of boundary faces at it. Unless the field names it, it stays if that is more than a hundredth, or
/// if it is on a patch without a surface, too. The same on any ranks. Collective: as `mesh::find_undescribed_patches`,
/// and three exchanges of shared nodes. Cost: a projection for each node on a curved wall.
NodesOffWalls find_nodes_off_walls(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders);

}  // namespace pamr::curved
