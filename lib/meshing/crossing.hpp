// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>

#include "meshing/meshing_domain.hpp"
#include "pamr/geometry/vec3.hpp"

namespace pamr::meshing {

/// A place where a straight way passes from one region into another one, or out of the domain.
struct Crossing {
  geometry::Vec3 point;               ///< in the middle between `end`
  std::array<geometry::Vec3, 2> end;  ///< on its sides, towards the first and the second end of the way
  std::array<int, 2> region;          ///< of these, -1 outside
};

/// Bisects the way from a to b, whose ends are given with their regions, which differ, until less than `error` is left:
/// the first half is taken where its ends have different regions. `around` (`Domain::around`) is asked only for middles
/// outside of what its earlier answers reach; `count` hears of every middle.
Crossing find_crossing(const std::array<geometry::Vec3, 2>& end, const std::array<int, 2>& region, double squared_error,
                       const std::function<Domain::Ball(geometry::Vec3)>& around,
                       const std::function<void(geometry::Vec3)>& count);

}  // namespace pamr::meshing
