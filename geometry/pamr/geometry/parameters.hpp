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

/// Whether all coordinates are below 1e30, so that volumes, mean ratios and squares of lengths are finite numbers.
inline bool is_in_range(Vec3 v) {
  constexpr double most = 1e30;
  return std::abs(v.x) < most && std::abs(v.y) < most && std::abs(v.z) < most;
}

/// Below this length a vector has no usable direction: its square underflows.
inline constexpr double min_length = 1e-140;

}  // namespace pamr::geometry
