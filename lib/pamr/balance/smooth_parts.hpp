// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::balance {

/// Parts, and how unlike they may be.
struct PartLimit {
  Rank n_parts = 1;
  double max_imbalance = 1;  ///< weight of a part over the mean
};

/// Makes the borders between parts smoother: a cell (or family) that has more faces with another part than with its own
/// goes over, as long as no part then weighs more than the limit. `part` (0 .. n_parts-1) of each of this
/// rank's cells is changed; families stay together. Returns the number of faces between parts that this saves, all
/// ranks. Collective: for each sweep one neighbor exchange and two reductions. Same result for the same distribution.
/// Source: the greedy form of B. W. Kernighan, S. Lin, "An efficient heuristic procedure for partitioning graphs",
/// 1970.
std::int64_t smooth_parts(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight,
                          const PartLimit& limit, std::vector<Rank>& part);

}  // namespace pamr::balance
