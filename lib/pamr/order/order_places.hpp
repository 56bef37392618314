// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/mesh/block_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::order {

/// The new number of each cell of the block: its place among all cells by key, then by old number. `key` has one entry
/// for each cell of the block. Collective: a sample sort.
std::vector<GlobalId> places_along_curve(const par::Comm& comm, const mesh::BlockMesh& block,
                                         std::span<const std::uint64_t> key);

}  // namespace pamr::order
