// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Reads a binary UGRID file (AFLR3, FUN3D) of reals of 8 and integers of 4 bytes, `.lb8.ugrid` (least byte first) or
/// `.b8.ugrid` (greatest byte first), whose cells are tetrahedra. Surface N becomes the patch `surface_N`, or has the
/// name and the kind that the file `.mapbc` beside it gives it, if there is one. Bytes that follow the cells in the file
/// are left out with a remark, as are lines of the `.mapbc` for surfaces that the mesh does not have.
///
/// Collective; every rank reads its share. Throws the same `Error` on every rank for what is no such file, with the
/// byte, and for what `mesh_of_elements` refuses.
ElementMesh read_ugrid(const par::Comm& comm, const std::filesystem::path& file, const ElementOptions& options = {});

}  // namespace pamr::io
