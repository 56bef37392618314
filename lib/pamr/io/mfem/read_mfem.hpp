// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Whether a file begins as a mesh of MFEM does, whose names often end in `.mesh` as those of Medit do. Collective: the
/// first rank looks.
bool is_mfem(const par::Comm& comm, const std::filesystem::path& file);

/// Reads a mesh in MFEM's format, "MFEM mesh v1.0" to "v1.3", of tetrahedra with straight edges. Attributes of elements
/// become the cell field `region`, those of boundary elements the patches `patch_N`; sets of one attribute each (v1.3)
/// give both their names.
///
/// Rank 0 reads the file as a whole. Collective. Throws the same `Error` on every rank, with the line, for what is no
/// such file, for nodes of higher order, and for what `mesh_of_elements` refuses.
ElementMesh read_mfem(const par::Comm& comm, const std::filesystem::path& file, const ElementOptions& options = {});

}  // namespace pamr::io
