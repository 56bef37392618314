// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "pamr/assemble/check_block.hpp"
#include "pamr/mesh/block_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::assemble {

/// This rank's cells in global numbers, ascending.
struct GlobalCells {
  std::vector<GlobalId> id;
  std::vector<std::array<GlobalId, 4>> node;
  std::vector<std::array<GlobalId, 4>> neighbor;  ///< empty: to be built
  std::vector<mesh::Lineage> lineage;
  std::vector<GlobalId> origin;  ///< empty: none
  std::vector<mesh::CellField> field;
};

/// Sends the cells to their ranks, in rounds of at most 2^17 cells a rank. Takes the cells out of the block.
/// Collective.
GlobalCells send_cells(const par::Comm& comm, mesh::BlockMesh& block, const std::vector<Rank>& to,
                       const Contents& contents);

}  // namespace pamr::assemble
