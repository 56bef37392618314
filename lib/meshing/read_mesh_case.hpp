// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "meshing/mesh_case.hpp"
#include "pamr/geometry/surface_set.hpp"

namespace pamr::meshing {

/// Reads the table `mesh` of a case file, and its surfaces where the shape is made of them (docs/tools/pamr-mesh.md).
/// `where` is the file's name. Local. Throws `Error` with the line for TOML errors, unknown keys, wrong types and
/// values out of range.
MeshCase read_mesh_case(std::string_view text, const std::string& where);

/// The surfaces of a case file, or of a file of nothing but surfaces, which keeps its text as it is. Local. Throws as
/// above.
geometry::SurfaceSet read_surfaces(std::string_view text, const std::string& where);

}  // namespace pamr::meshing
