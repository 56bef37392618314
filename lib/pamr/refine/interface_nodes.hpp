// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/new_level.hpp"

namespace pamr::refine {

/// This level's nodes on faces between cells with different values of `mesh::region_field`, ascending. What moves inner
/// nodes leaves them in the middles of their edges, so that the faces between regions keep their shape. The same nodes
/// on any ranks. Collective: with such a field a reduction, and with several regions one exchange over the shared
/// nodes. O(cells).
std::vector<LocalId> interface_nodes(const par::Comm& comm, const NewLevel& level);

}  // namespace pamr::refine
