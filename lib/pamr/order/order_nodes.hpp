// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "pamr/mesh/block_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::order {

/// The nodes that cells name, in order of first use, and each corner's place among them.
struct Named {
  std::vector<GlobalId> node;
  std::vector<LocalId> corner;  ///< 4 a cell
};

/// Local.
Named find_named(const std::vector<std::array<GlobalId, 4>>& cell_to_node);

/// Numbers the nodes in the order in which the cells name them, moves positions and fields to their new blocks and
/// returns what the numbers were before. `block` holds the cells in canonical blocks, with old node numbers.
/// Collective.
std::vector<GlobalId> renumber_nodes(const par::Comm& comm, mesh::BlockMesh& block);

}  // namespace pamr::order
