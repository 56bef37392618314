// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "pamr/adapt/pass.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/options.hpp"

namespace pamr::adapt {

/// The floor that the default one is compared with: none, and 0.3 for a mesh with a map of level 0, whose cells at coarse
/// walls would have no shape without a floor.
double lower_floor(const mesh::DistMesh& mesh);

/// About how many cells a mesh would have if it were closed with `lower_floor`, all ranks: it is closed once more,
/// without look-ahead splits. Nothing for other floors than the default; and in a mesh with a map of level 0 where that
/// cannot ask for much: there are no look-ahead splits, and few cells become eight that nobody asked for and that descend
/// from cells of level 0 whose children are near the floor.
/// `closed`: as `close_pass` leaves it. Collective. Cost: that of `refine::close` with the lower floor.
std::optional<std::int64_t> cells_with_lower_floor(const par::Comm& comm, const Closed& closed,
                                                   const refine::Options& options);

/// How many cells more a mesh will have, about, as a share of those with the lower floor. The same on any number of
/// ranks. `closed`: with its look-ahead splits. Collective.
double floor_cost(const par::Comm& comm, const Closed& closed, std::int64_t cells_with_lower);

}  // namespace pamr::adapt
