// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "pamr/geometry/vec3.hpp"

namespace pamr::dsmc {

using geometry::Vec3;

/// Which side of a patch inside the gas is the front.
struct Facing {
  Vec3 value;               ///< a direction, or a point in meters
  bool from_point = false;  ///< the front looks away from the point, else along the direction

  /// How far a side looks to the front: above 0 at the front, below at the back; -1 to 1. `normal`: unit, out of the
  /// gas at that side; `center`: of the face, m.
  double of_side(Vec3 normal, Vec3 center) const {
    const Vec3 along = from_point ? center - value : value;
    const double length = norm(along);
    return length > 0 ? -dot(normal, along) / length : 0;
  }
};

/// A patch of faces inside the gas, thin walls: the gas on each side meets a wall of its own.
struct InnerWall {
  int patch = 0;              ///< of the mesh
  std::array<int, 2> side{};  ///< indices of the conditions of front and back
  Facing facing;

  int side_of(Vec3 normal, Vec3 center) const { return side[facing.of_side(normal, center) > 0 ? 0 : 1]; }
};

/// The wall that a patch of the mesh is; null: none.
inline const InnerWall* find_wall(std::span<const InnerWall> walls, int patch) {
  for (const auto& wall : walls)
    if (wall.patch == patch) return &wall;
  return nullptr;
}

}  // namespace pamr::dsmc
