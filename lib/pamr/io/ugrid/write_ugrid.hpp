// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/io/written_names.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Writes nodes, boundary triangles (inward, as the program refine has them) and tetrahedra as a binary UGRID file, in
/// global order, with the greatest byte first for `.b8.ugrid` and the least for `.lb8.ugrid`, and beside it the file
/// `.mapbc` with the number, condition and name of each patch that has faces, with `_` for blanks at the ends of names.
/// A patch `surface_N` has number N, others the lowest free ones from 1 on. Fields and regions have no place in the
/// format. The same bytes on any number of ranks.
/// Collective; throws the same `Error` on every rank, also for more than 2^31 - 1 nodes, triangles or cells, and leaves
/// nothing behind then.
void write_ugrid(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                 const Remark& remark = {});

/// The file beside it.
std::filesystem::path mapbc_file(const std::filesystem::path& file);

}  // namespace pamr::io
