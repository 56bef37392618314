// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Writes the boundary of a mesh as a surface of triangles, seen counter-clockwise from outside of the mesh. The
/// extension says how: STL and OBJ and OFF as text, PLY in bytes, all with every bit of the coordinates; `.vtp` (VTK
/// PolyData, text) with the cell fields `patch` (number) and `cell` (number of the cell behind).
/// - `patches`: names of those to write, their faces inside from the cell with the lower number; the whole boundary when
///   empty. Throws `Error` for a name that the mesh does not have, and for
///   a surface without triangles.
/// - Order: by cell, the faces of a cell by slot; points by their first use. The bytes are the same on any number of
/// ranks.
/// - Collective; no rank holds the surface. Throws the same `Error` on every rank, and leaves nothing behind then.
void write_boundary(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                    const std::vector<std::string>& patches = {});

}  // namespace pamr::io
