// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// Checks of the parameters of a surface: each returns its argument or throws `Error` that says what was expected and
/// found; `what` is the name of the parameter.

/// A point whose coordinates are all finite.
Vec3 checked_point(Vec3 point, std::string_view what);
/// The unit vector of a direction; zero and non-finite vectors are refused.
Vec3 checked_direction(Vec3 vector, std::string_view what);
/// A finite length greater than zero.
double checked_length(double length, std::string_view what);

/// The shortest decimal text that reads back as the same double.
std::string decimal(double value);
/// The same for a vector: "[x, y, z]".
std::string decimal(Vec3 value);

/// Largest absolute coordinate.
inline double largest_coordinate(Vec3 v) { return std::fmax(std::fmax(std::abs(v.x), std::abs(v.y)), std::abs(v.z)); }

/// Coordinates are below this, so that the measures of shapes, which have up to the eighth power of lengths, are finite.
inline constexpr double max_coordinate = 1e30;
inline constexpr const char* max_coordinate_text = "1e30";  ///< for messages

/// Meshes are larger than this, for the same measures.
inline constexpr double min_extent = 1e-30;

/// Whether all coordinates are, and none is NaN.
inline bool is_in_range(Vec3 v) {
  return std::abs(v.x) < max_coordinate && std::abs(v.y) < max_coordinate && std::abs(v.z) < max_coordinate;
}

/// Below this length a vector has no usable direction: its square underflows.
inline constexpr double min_length = 1e-140;

}  // namespace pamr::geometry
