// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/mesh/block_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::order {

/// Numbers the nodes in the order in which the cells name them, moves positions and fields to their new blocks and
/// returns what the numbers were before. `block` holds the cells in canonical blocks, with old node numbers.
/// Collective.
std::vector<GlobalId> renumber_nodes(const par::Comm& comm, mesh::BlockMesh& block);

}  // namespace pamr::order
