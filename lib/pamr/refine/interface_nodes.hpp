// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/number.hpp"

namespace pamr::refine {

/// The new nodes on faces between cells with different values of `mesh::region_field` and on faces inside that have a
/// patch, ascending. What moves inner nodes leaves them in the middles of their edges, so that such faces keep their
/// shape. The same nodes on any ranks. Collective: a reduction, and where there may be some one exchange over the shared
/// nodes. O(cells). `shared`: nodes that other ranks hold too.
std::vector<LocalId> interface_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, const Numbering& numbering,
                                     const par::Pattern& shared);

}  // namespace pamr::refine
