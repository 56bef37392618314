// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/adapt/pass.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/options.hpp"

namespace pamr::adapt {

/// The floor that the default one is compared with.
inline constexpr double lower_shape_floor = 0.3;

/// How many cells more the default shape floor makes of a mesh with a map of level 0 than `lower_shape_floor` would, at
/// least about, as a share of what that would make: by closing the mesh once more, without the look-ahead splits, of which
/// the default floor needs more. 0 for other floors, for meshes without a map, and where the floor cannot ask for
/// much: where few cells become eight that nobody asked for and that descend from cells of level 0 whose children are
/// near the floor. The same on any number of ranks.
/// `closed`: as `close_pass` leaves it. Collective. Cost: O(cells) and two reductions, or that of `refine::close`.
double floor_cost(const par::Comm& comm, const Closed& closed, const refine::Options& options);

}  // namespace pamr::adapt
