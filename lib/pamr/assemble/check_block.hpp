// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "pamr/mesh/block_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::assemble {

/// What the blocks hold, the same on every rank.
struct Contents {
  bool has_neighbors = false;
  bool has_boundary = false;
  bool has_lineage = false;
  bool has_origin = false;
  bool has_destinations = false;
};

/// Refuses blocks whose sizes do not fit together and numbers out of range. Collective.
Contents check_block(const par::Comm& comm, const mesh::BlockMesh& block, std::span<const Rank> destination);

/// The rank each cell of the block goes to: its destination, or this rank where there are none; whole closure families
/// go where their first member goes. Refuses families that are not whole. Collective: one sparse exchange.
std::vector<Rank> family_destinations(const par::Comm& comm, const mesh::BlockMesh& block,
                                      std::span<const Rank> destination, const Contents& contents);

}  // namespace pamr::assemble
