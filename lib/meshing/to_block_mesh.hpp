// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "meshing/meshing_domain.hpp"
#include "meshing/raw_mesh.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::meshing {

/// The mesh that rank 0 made, with neighbors built from its faces, as the blocks that `assemble::assemble` takes: all
/// cells on rank 0, the nodes in canonical blocks. `mesh` is read on rank 0 only, `domain` must be the same everywhere.
/// Collective. Throws `Error` on every rank for a face in three cells or a boundary face in no patch.
mesh::BlockMesh to_block_mesh(const par::Comm& comm, const Domain& domain, const RawMesh& mesh);

/// The rank that gets each cell of this rank's block: canonical blocks of all cells. Collective.
std::vector<Rank> block_destinations(const par::Comm& comm, const mesh::BlockMesh& block);

}  // namespace pamr::meshing
