// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "meshing/solid.hpp"

namespace pamr::meshing {

/// The lines of the divided surfaces of a solid (creases of triangulated ones, edges of CAD shapes), cut where another
/// surface crosses them.
struct CutCreases {
  /// What is left of one line of creases between two cuts, or all of it.
  struct Part {
    int surface = 0;
    std::size_t line = 0;                  ///< of the surface
    std::vector<geometry::Vec3> polyline;  ///< finely; closed where it ends in its first point
  };
  std::vector<Part> parts;              ///< those on the boundary of the solid
  std::vector<geometry::Vec3> corners;  ///< where another surface meets a crease; parts end in them to the last bit
};

/// Cuts by bisection along the crease, to rounding. Local, deterministic. Throws `Error` for a crease that lies in
/// another surface where both bound the solid. Cost: a nearest point of each surface for each point of the polylines.
CutCreases cut_creases(const Solid& solid);

}  // namespace pamr::meshing
