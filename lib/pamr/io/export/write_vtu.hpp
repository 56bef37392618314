// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/second_order.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Writes a mesh and its fields as one `.vtu` file (VTK XML unstructured grid, binary data appended), in global order:
/// the same bytes on any number of ranks. Real fields are written as 64-bit reals, integers as 64-bit integers.
/// The triangles of the boundary follow the cells, outward, in the order of their cells, with the values of these.
/// Besides the fields of the mesh, cells and triangles have `level` (8 bits) and `mean_ratio` (32 bits) where no field
/// has the name, and `patch`: that of a triangle, -1 for a cell (`boundary_patch` where a field has that name). The
/// field data have an array `patch NAME` with the number of each patch. Neighbors and what closure cells come from have
/// no place in the format. With `second_order` cells and triangles are of second order (VTK's types 24 and 22), and the
/// node fields are those that it has.
/// Collective; throws the same `Error` on every rank, and leaves nothing behind then.
void write_vtu(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
               const mesh::SecondOrder* second_order = nullptr);

}  // namespace pamr::io
