// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::coarsen {

/// Where the cells of this rank have to go so that every octet all of whose cells may be coarsened lies on one rank:
/// that of its first cell. All others stay. `flags`: one for each cell. Collective: two sparse exchanges of the cells
/// that may be coarsened and whose siblings are not all here; empty on every rank if there are none.
std::vector<Rank> gather_siblings(const par::Comm& comm, const mesh::DistMesh& mesh,
                                  std::span<const std::int8_t> flags);

}  // namespace pamr::coarsen
