// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "pamr/par/comm.hpp"

namespace pamr::par {

/// Some of all ids with new numbers from 0 on, without gaps and in their old order.
struct Renumbered {
  GlobalId n = 0;                ///< how many were named, over all ranks
  std::vector<GlobalId> new_id;  ///< of each id that this rank names
};

/// Numbers those of the ids `all` that some rank names; several ranks may name the same one, and one rank may name it several
/// times. Collective.
Renumbered renumber(const Comm& comm, IdRange all, std::span<const GlobalId> ids);

}  // namespace pamr::par
