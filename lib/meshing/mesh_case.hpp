// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "meshing/blunt_cone.hpp"
#include "meshing/combination.hpp"

namespace pamr::meshing {

inline constexpr double default_box_size = 0.28;

/// What is to be meshed with CGAL.
struct MeshCase {
  std::string shape;
  std::uint32_t seed = 0;
  BluntConeSizes blunt_cone;           ///< of that shape
  BluntConeGeometry cone_geometry;     ///< of that shape
  double box_size = default_box_size;  ///< edge length, of sphere-in-box
  Combination combination;             ///< of the other shapes
  std::string where;                   ///< the file, or the shape where there is none: begins errors
};

/// The case that `--shape` and, unless 0, `--size` ask for. Throws `Error` for an unknown shape.
MeshCase case_of_shape(const std::string& shape, double size);

/// The domain of a case. Throws `Error`.
Domain domain_of(const MeshCase& mesh_case);

/// One line that names everything that decides the mesh.
std::string describe(const MeshCase& mesh_case);

}  // namespace pamr::meshing
