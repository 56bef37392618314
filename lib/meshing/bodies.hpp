// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/geometry/surface_set.hpp"

namespace pamr::meshing {

/// For each surface the number of what has sides: the surface itself, but all CAD surfaces on one shape together are
/// one. Ascending from 0 in the order in which they first occur.
std::vector<int> sides_of(const geometry::SurfaceSet& surfaces);

/// The surfaces of a case as they have sides.
struct Bodies {
  geometry::SharedSurfaces set;  ///< a `CadBody` for each CAD shape, with the name of its first surface
  std::vector<int> first;        ///< by body: its first surface
  std::vector<std::vector<int>> surface_of_face;  ///< by body and face of a CAD shape: the surface; empty for others
};

/// Throws `Error` for a CAD shape that is not closed, and where a face lies on no surface or on two. `longest_error` as
/// for `CadBody`.
Bodies join_bodies(const geometry::SurfaceSet& surfaces, double longest_error);

}  // namespace pamr::meshing
