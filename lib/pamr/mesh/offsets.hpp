// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

/// For each cell of this rank: `start` and the counts of all cells with smaller numbers, those of other ranks included.
/// `in_runs`: `cell_runs` is not empty. Collective: one exclusive sum where ranks hold runs, else two sparse exchanges
/// of 16 bytes for each run of consecutive numbers that this rank holds.
std::vector<GlobalId> cell_offsets(const par::Comm& comm, const DistMesh& mesh, Exact<bool> in_runs,
                                   std::span<const std::uint8_t> counts, Exact<GlobalId> start);

/// The same for nodes; ranks that hold the same node give the same count. Collective: four sparse exchanges.
std::vector<GlobalId> node_offsets(const par::Comm& comm, const DistMesh& mesh, std::span<const std::uint8_t> counts,
                                   GlobalId start);

}  // namespace pamr::mesh
