// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/geometry/surface_set.hpp"

namespace pamr::geometry {

/// The surfaces of a mesh whose coordinates are multiplied by `factor` (above 0): points and radii are multiplied, axes,
/// normals and angles stay. The description is written anew; names and order stay. Local.
/// Throws `Error` that names the first surface of another kind than plane, sphere, cylinder, cone and torus.
SurfaceSet scaled(const SurfaceSet& set, double factor);

}  // namespace pamr::geometry
