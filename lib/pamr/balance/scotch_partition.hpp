// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/balance/dual_graph.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::balance {

/// Whether this build has PT-Scotch; where it has none, pieces of the curve take its place. Local.
bool has_scotch();

/// Part (0 .. n_parts-1) of each of this rank's vertices, by PT-Scotch: parts that weigh the same within `tolerance`
/// (a fraction) as nearly as it can, few faces between parts. One thread, fixed seed: the same partition on every run
/// with the same distribution of the graph; another distribution gives another one.
/// Collective; Scotch communicates by itself over the communicator. Pre: positive weights whose sum is below 2^62, at
/// least as many vertices as parts. Throws `Error` on every rank when Scotch reports one.
/// Source: F. Pellegrini, "PT-Scotch and libPTScotch 7.0 User's Guide", 2023.
std::vector<Rank> scotch_partition(const par::Comm& comm, const DualGraph& graph, Rank n_parts, double tolerance);

}  // namespace pamr::balance
