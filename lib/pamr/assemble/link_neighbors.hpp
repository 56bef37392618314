// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "pamr/assemble/check_block.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::assemble {

/// Which rank holds a cell: one of the two.
struct CellOwners {
  /// Where every rank holds a run of numbers: the first cell of each rank, ascending; the same on every rank.
  std::vector<GlobalId> first;
  /// Otherwise the rank that holds each cell of this rank's canonical block of cells; other ranks ask for it.
  std::vector<Rank> of_block;
};

/// Finds them from the numbers `id` of this rank's cells, ascending. Collective.
CellOwners find_owners(const par::Comm& comm, IdRange cells, const std::vector<GlobalId>& id, const Contents& contents);

/// Sets `cell_to_cell` and the rank-border faces from global neighbors, whose patches must be in range. Refuses
/// neighbors that are not reciprocal. Collective.
void link_neighbors(const par::Comm& comm, mesh::DistMesh& mesh, std::vector<std::array<GlobalId, 4>> neighbor,
                    const CellOwners& owners);

}  // namespace pamr::assemble
