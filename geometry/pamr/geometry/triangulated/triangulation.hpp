// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// A named surface of flat triangles as it was given: the data of a surface, not yet something that answers `project`.
struct Triangulation {
  std::string name;
  std::vector<Vec3> points;                   ///< length unit of the mesh
  std::vector<std::array<int, 3>> triangles;  ///< n x 3, numbers of points
  /// What its file says beyond that, which is left out, as sentences. Not kept in mesh files.
  std::vector<std::string> remarks = {};

  friend bool operator==(const Triangulation&, const Triangulation&) = default;
};

}  // namespace pamr::geometry
