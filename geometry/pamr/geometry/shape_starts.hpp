// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "pamr/geometry/fit_shape.hpp"
#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// Shapes of a kind near some points with approximate unit normals, for least squares to begin at: one for each
/// direction that the axis may have. Those are the directions of least and most spread of the points and of the
/// normals, and the axis that all normals meet. Source: H. Pottmann, J. Wallner, "Computational line geometry",
/// Springer 2001, section 4.2 (the normals of a surface of revolution lie in a linear complex of lines).
/// Pre: coordinates of about 1. Local.
std::vector<FittedShape> shape_starts(ShapeKind kind, std::span<const Vec3> point, std::span<const Vec3> normal);

/// Largest distance of a point from the plane that fits them best.
double distance_from_plane(std::span<const Vec3> point);

}  // namespace pamr::geometry
