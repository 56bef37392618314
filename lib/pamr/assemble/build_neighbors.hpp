// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::assemble {

/// Sets `cell_to_cell` and the rank-border faces from the nodes alone; faces without a second cell get patch 0. Refuses
/// a face in three cells. Collective.
void build_neighbors(const par::Comm& comm, mesh::DistMesh& mesh);

}  // namespace pamr::assemble
