// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "meshing/combination.hpp"

namespace pamr::meshing {

/// A sector of the gas around a sphere about the origin, meters: x along the flow, between two planes through the x
/// axis, from z = 0 towards y, 1 / `parts` of a full turn.
struct SupersonicSphere {
  double radius = 5e-3;
  double parts = 16;             ///< 2, 3, ... 32
  double inflow = 0;             ///< distance of the inflow plane from the center; 0: 4 radii
  double outflow = 0, side = 0;  ///< of the outflow plane and of the outer cylinder; 0: 6 and 5 radii
  /// Wanted edge lengths at the sphere and elsewhere. 0: a fifth of the radius, four fifths.
  double size_sphere = 0, far = 0, growth = 0.35;
};

/// Patches `sphere`, `inflow`, `outflow`, `side`, `symmetry_1` (z = 0), `symmetry_2` (none for a half). Throws `Error`
/// for borders that touch the sphere, and for sizes out of range.
Combination supersonic_sphere(const SupersonicSphere& parameters);

}  // namespace pamr::meshing
