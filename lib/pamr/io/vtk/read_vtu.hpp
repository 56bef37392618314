// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Reads an unstructured grid of VTK in XML (.vtu) of one piece: its tetrahedra, with point and cell data as fields.
/// Data may be text, base64 or raw, compressed by zlib or not. Triangles on the boundary become patches `patch_N` by
/// the first integer cell array of one component named `boundary_patch`, `patch`, or as VTK and meshio call tags
/// (`gmsh:physical`, `medit:ref`, `CellEntityIds`, ...), which is no field then; the latter are the regions of the
/// tetrahedra, too. Without such an array triangles are left out, vertices and lines always. Field data `patch NAME`
/// give the patch of that number its name, as in the files of `write_vtu`, and mark these: `mean_ratio` as it writes it
/// is no field. `level` of 8 bits never is one, as in native files.
///
/// Rank 0 reads the file as a whole, as befits a format of text. Collective. Throws the same `Error` on every rank for
/// what is no such file, and for what `mesh_of_elements` refuses.
ElementMesh read_vtu(const par::Comm& comm, const std::filesystem::path& file, const ElementOptions& options = {});

}  // namespace pamr::io
