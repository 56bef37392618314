// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Writes a mesh and its fields as one `.vtu` file (VTK XML unstructured grid, binary data appended), in global order:
/// the same bytes on any number of ranks. Real fields are written as 64-bit reals, integers as 64-bit integers.
/// Patches, neighbors and lineage have no place in the format. Collective; throws the same `Error` on every rank, and
/// leaves nothing behind then.
void write_vtu(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh);

}  // namespace pamr::io
