// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/par/comm.hpp"

namespace pamr::balance {

/// Cuts the cells, in their global order, into one run for each rank so that the runs weigh the same as nearly as whole
/// cells allow: the rank of each of this rank's cells. As good as the order of the cells is local (files of `pamr-mesh`
/// follow a Hilbert curve, and children follow their parents).
/// `weight`: positive, one for each cell of this rank, the ranks' cells following one another in global order.
/// Collective: one exclusive sum and one sum. Order-free, so the same for any distribution of the input.
std::vector<Rank> weighted_blocks(const par::Comm& comm, std::span<const std::int64_t> weight);

}  // namespace pamr::balance
