// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Reads an unstructured grid in VTK's legacy format (.vtk), version 1 to 5, text or binary: tetrahedra, fields, and
/// patches as `read_vtu` does. Metadata, tables of colors and texts are passed over.
///
/// Rank 0 reads the file as a whole. Collective. Throws the same `Error` on every rank, with line or byte, for what is
/// no such file, for other kinds of grids by name, and for what `mesh_of_elements` refuses.
ElementMesh read_legacy_vtk(const par::Comm& comm, const std::filesystem::path& file,
                            const ElementOptions& options = {});

}  // namespace pamr::io
