// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/number.hpp"
#include "pamr/refine/relink_border.hpp"
#include "pamr/refine/subdivide.hpp"

namespace pamr::refine {

/// What is behind each face of the children; the arrays of the same names of `mesh::DistMesh`.
struct Links {
  std::vector<mesh::CellNeighbors> cell_to_cell;
  BorderLinks border;
};

/// The cell neighbors and rank-border faces of the children. New neighbors follow from constant tables and the old
/// neighbors; only faces between two families that were both taken back are matched by their nodes, and faces on rank
/// borders by the global numbers of theirs (`node_global`: of every node of the refined mesh).
/// Collective: one sparse exchange with the neighbors over the rank border. Cost: constant for each child.
Links relink(const par::Comm& comm, const NumberedMesh& old, const Children& children,
             const std::vector<GlobalId>& node_global);

}  // namespace pamr::refine
