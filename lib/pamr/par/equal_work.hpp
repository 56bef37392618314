// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::par {

/// Cuts a row of items into runs that weigh the same as nearly as whole items allow: the run, 0 to `n_runs` - 1, in
/// which the middle of each of this rank's items falls. `weight`: positive, one for each item of this rank, the ranks'
/// items following one another, of sum at most 2^61. Does not depend on how the items are spread over the ranks.
/// Collective: one gather of a number a rank.
std::vector<Rank> runs_of_equal_work(const Comm& comm, std::span<const std::int64_t> weight, Exact<Rank> n_runs);
/// The same for weights below 256. Collective.
std::vector<Rank> runs_of_equal_work(const Comm& comm, std::span<const std::uint8_t> weight, Exact<Rank> n_runs);

}  // namespace pamr::par
