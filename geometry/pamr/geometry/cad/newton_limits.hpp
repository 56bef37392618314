// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// When the searches for nearest points on edges and faces stop; lengths relative to the size of the shape.
namespace pamr::geometry::newton {

inline constexpr int max_steps = 60;
inline constexpr double at_rest = 1e-15;
/// Steps of this length that do not shrink are rounding.
inline constexpr double rounding = 1e-12;
/// Of shorter steps the distances are rounding: they are not required to fall.
inline constexpr double sure_to_fall = 1e-7;

}  // namespace pamr::geometry::newton
