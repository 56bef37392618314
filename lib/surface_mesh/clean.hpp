// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::surface_mesh {

/// Single steps of a repair that take any triangles. Each returns how many it changed. Local, serial.

/// Takes out points that no triangle uses.
std::int64_t drop_unused(geometry::Triangulation& surface);
/// Makes points that are no farther apart than `distance` (0: at the same place) one, at the place of the first; chains
/// of them too. Returns how many points went. O(n log n).
std::int64_t weld(geometry::Triangulation& surface, double distance);
/// Takes out triangles with a point twice.
std::int64_t drop_collapsed(geometry::Triangulation& surface);
/// Takes out triangles with the points of an earlier one, in any order.
std::int64_t drop_duplicates(geometry::Triangulation& surface);

struct DroppedShells {
  std::int64_t n_shells = 0, n_triangles = 0;
};
/// Takes out shells with an area below `min_area`, and open ones below 1 % of the area of all. Pre: a manifold.
DroppedShells drop_small_shells(geometry::Triangulation& surface, double min_area);

struct TurnedShells {
  std::int64_t n_outwards = 0, n_inwards = 0;
};
/// Turns closed shells inside out that are seen from the wrong side: a shell in no other one, or in an even number, is
/// to face outwards, one in an odd number is a cavity and is to face inwards. Shells that touch or cut others are left
/// as they are. Pre: a manifold of one orientation without triangles that have no area.
TurnedShells turn_shells(geometry::Triangulation& surface);

struct MendedFlat {
  std::int64_t n_collapsed = 0, n_flipped = 0, n_left = 0;
};
/// Takes out triangles without area (`is_flat`): collapses their shortest edge, or flips the longest one where the
/// third point lies on it, in half-edges of OpenMesh. Pre: a manifold of one orientation without triangles that have a
/// point twice.
MendedFlat mend_flat(geometry::Triangulation& surface);

}  // namespace pamr::surface_mesh
