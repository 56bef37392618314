// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/number.hpp"
#include "pamr/refine/subdivide.hpp"

namespace pamr::refine {

/// Gives the children in `fine` (nodes, cells and their numbers set) their cell neighbors and rank-border faces. New
/// neighbors follow from constant tables and the old neighbors; only faces between two families that were both taken
/// back are matched by their nodes, and faces on rank borders by the global numbers of theirs.
/// Collective: one sparse exchange with the neighbors over the rank border. Cost: constant for each child.
void relink(const par::Comm& comm, const mesh::DistMesh& old, const Closure& closure, const Numbering& numbering,
            const Children& children, mesh::DistMesh& fine);

}  // namespace pamr::refine
