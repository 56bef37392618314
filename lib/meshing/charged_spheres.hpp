// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "meshing/combination.hpp"

namespace pamr::meshing {

/// Two equal spheres in a liquid, in any unit, as a rule Debye lengths: centers at x = +- distance / 2, y = 0,
/// z = height above the plate z = 0. The mesh is the quarter x, y >= 0 and holds half a sphere. Without plate (height
/// 0) the mirror z = 0 takes its place: an eighth with a quarter of a sphere.
struct ChargedSpheres {
  double radius = 0.325, distance = 4.5, height = 2.5;
  double half_length = 0;  ///< x of the end wall; 0: distance / 2 + 7.5
  double width = 0;        ///< y of the side wall; 0: 7.5
  double top = 0;          ///< z of the lid; 0: height + 7.5
  /// Wanted edge lengths at the sphere, at the plate, at the outer walls, and the largest. 0: of the default mesh, in
  /// proportion to `far`; at the sphere at most 0.6 radii.
  double size_sphere = 0, size_plate = 0, size_walls = 0, far = 0.5, growth = 0.35;
};

/// Patches `sphere`, `plate` (or `symmetry_z`), `symmetry_x`, `symmetry_y`, `end`, `side`, `lid`. Throws `Error` when
/// the sphere does not fit between mirror, plate and walls, and for sizes out of range.
Combination charged_spheres(const ChargedSpheres& parameters);

/// One sphere about the origin in an octant of a spherical shell of liquid.
struct ChargedSphere {
  double radius = 1.0;
  double outer_radius = 0;  ///< 0: radius + 8
  double size_sphere = 0;   ///< 0: a quarter of the radius
  double size_outer = 0;    ///< 0: as `far`
  double far = 1.2, growth = 0.35;
};

/// Patches `sphere`, `outer`, `symmetry_x`, `symmetry_y`, `symmetry_z`. Throws `Error` as above.
Combination charged_sphere(const ChargedSphere& parameters);

}  // namespace pamr::meshing
