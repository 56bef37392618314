// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::surface_mesh {

/// Multiplies all coordinates. Throws `Error` where they leave the range of coordinates, or corners of a triangle come
/// to one place.
void scale(geometry::Triangulation& surface, double factor);
/// Adds a vector to all points. Throws `Error` as `scale` does.
void translate(geometry::Triangulation& surface, geometry::Vec3 by);

/// Meters of a unit of length: "nm", "um", "mm", "cm", "dm", "m", "km", "in" or "ft". Throws `Error` for others.
double meters_of(std::string_view unit);
/// The names of these units, for help texts.
std::string known_units();

}  // namespace pamr::surface_mesh
