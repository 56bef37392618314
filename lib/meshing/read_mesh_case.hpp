// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "meshing/mesh_case.hpp"
#include "pamr/geometry/surface_set.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::meshing {

/// Reads the table `mesh` of a case file, and its surfaces where the shape is made of them (docs/tools/pamr-mesh.md).
/// `where` is the file's name. Local. Throws `Error` with the line for TOML errors, unknown keys, wrong types and
/// values out of range.
MeshCase read_mesh_case(std::string_view text, const std::string& where);

/// The surfaces of a case file, or of a file of nothing but surfaces, which keeps its text as it is, for a mesh with
/// these patches: they choose the parts of files of triangles (`parts_with_patch`). Local. Throws as above.
geometry::SurfaceSet read_surfaces(std::string_view text, const std::string& where,
                                   const std::vector<mesh::Patch>& patches);

}  // namespace pamr::meshing
