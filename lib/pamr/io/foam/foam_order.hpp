// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// How many inner faces of the mesh in a case of OpenFOAM lie between other cells than the inner faces of a mesh, in the
/// order of `write_foam`: 0 where the cells of both have the same numbers, so that values may go over by row. Where the
/// folder has no `constant/polyMesh` there is nothing to compare, and 0. Other numbers of faces count as different.
///
/// Collective; the first rank holds two numbers a face. Throws the same `Error` on every rank for files that are none.
std::int64_t count_other_faces(const par::Comm& comm, const std::filesystem::path& case_folder,
                               const mesh::DistMesh& mesh);

}  // namespace pamr::io
