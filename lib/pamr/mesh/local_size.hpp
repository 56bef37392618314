// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "pamr/base/exact.hpp"
#include "pamr/base/types.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

/// The most cells that one rank may hold. Each may bring four nodes, or four ghosts that are numbered after the cells,
/// and all of these still have local numbers of 32 bits.
inline constexpr std::int64_t max_local_cells = std::numeric_limits<LocalId>::max() / 5;

/// Refuses more cells on any rank than it could number. `n_cells` is what this rank is about to hold, `what` says of
/// what. Throws the same `Error` on every rank. Collective: one reduction.
void require_local_size(const par::Comm& comm, Exact<std::int64_t> n_cells, const std::string& what);

}  // namespace pamr::mesh
