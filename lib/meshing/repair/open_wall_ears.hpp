// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "meshing/repair/find_wall_ears.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::meshing {

/// Takes the ears away: splits each edge of `ears`, and so all cells around it, by a new node, and each face of them,
/// and so the cells at it, by another.
///
/// - The boundary keeps its shape, and so do faces between regions and inner faces with a patch: new nodes in them lie in
///   the middle.
/// - Edges are split in falling order of length, so that neighbors agree on their common faces.
/// - Children take the place of their parent in the order of cells, new nodes come last.
/// - Other new nodes go where the cells at them are best (`improve_nodes`). So do inner nodes of the split cells where the
///   cells are poor, unless a node field would have to follow.
/// - Cell fields are copied, node fields averaged.
///
/// Pre: `ears` of this mesh, all cells regular. Collective; every rank gets the cells to be split and those next to
/// them. The result depends on the mesh only, not on ranks.
mesh::DistMesh open_wall_ears(const par::Comm& comm, mesh::DistMesh mesh, const WallEars& ears);

}  // namespace pamr::meshing
