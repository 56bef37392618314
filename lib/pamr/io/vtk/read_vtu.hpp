// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Reads an unstructured grid of VTK in XML (.vtu) of one piece: its tetrahedra, with point and cell data as fields.
/// Data may be text, base64 or raw, compressed by zlib or not. Triangles on the boundary become patches `patch_N` by
/// the first integer cell array of one component named `boundary_patch`, `patch`, `gmsh:physical`, `CellEntityIds` or
/// `medit:ref`, which is no field then; without such an array, and vertices and lines always, they are left out. Field
/// data `patch NAME` give the patch of that number its name, as in the files of `write_vtu`, and mark these:
/// `mean_ratio` as it writes it is no field. `level` of 8 bits never is one, as in native files. Cells are put in order
/// along Hilbert's curve. Inverted cells are turned over.
///
/// Rank 0 reads the file as a whole, as befits a format of text. Collective. Throws the same `Error` on every rank for
/// what is no such file, other cells, and what `assemble::assemble` refuses.
ElementMesh read_vtu(const par::Comm& comm, const std::filesystem::path& file);

}  // namespace pamr::io
