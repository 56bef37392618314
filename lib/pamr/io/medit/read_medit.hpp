// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

struct MeditOptions : ElementOptions {
  std::filesystem::path solution = {};        ///< .sol or .solb with fields of this mesh; empty: none
  std::vector<std::string> field_names = {};  ///< of its fields, in order; empty: `sol_1`, `sol_2`, ...
};

/// Reads a mesh in Medit's format, text (`.mesh`) or binary (`.meshb`, versions 1 to 4, either order of bytes), whose
/// cells are tetrahedra, and the fields on its vertices and tetrahedra. The format knows references alone: triangles of
/// reference N become the patch `ref_N`; references of tetrahedra the cell field `region`. What
/// else it may hold (edges, corners, normals, references of vertices that are not all alike) is left out with a remark.
///
/// Collective; every rank reads its share. In a text each vertex and element has to be a line of its own. Throws the
/// same `Error` on every rank, with line or byte, for what is no such file, for two dimensions, for fields that do not
/// fit the mesh or the names, and for what `mesh_of_elements` refuses.
ElementMesh read_medit(const par::Comm& comm, const std::filesystem::path& file, const MeditOptions& options = {});

}  // namespace pamr::io
