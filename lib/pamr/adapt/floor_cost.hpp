// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "pamr/adapt/pass.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/options.hpp"

namespace pamr::adapt {

/// The floor that the default one is compared with.
inline constexpr double lower_shape_floor = 0.3;

/// About how many cells a mesh would have if it were closed with `lower_shape_floor`, all ranks: it is closed once more,
/// without the look-ahead splits. Nothing for other floors than the default, and where that cannot ask for much: where
/// there are no look-ahead splits, and few cells become eight that nobody asked for and, in a mesh with a map of level 0,
/// that descend from cells of level 0 whose children are near the floor.
/// `closed`: as `close_pass` leaves it. Collective. Cost: O(cells) and a reduction, or that of `refine::close`.
std::optional<std::int64_t> cells_with_lower_floor(const par::Comm& comm, const Closed& closed,
                                                   const refine::Options& options);

/// How many cells more a mesh will have, about, as a share of those with the lower floor. The same on any number of
/// ranks. `closed`: with its look-ahead splits. Collective.
double floor_cost(const par::Comm& comm, const Closed& closed, std::int64_t cells_with_lower);

}  // namespace pamr::adapt
