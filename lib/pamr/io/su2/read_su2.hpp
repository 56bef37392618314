// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Reads a mesh in SU2's format whose cells are tetrahedra. Markers become patches of the same names, but for those of
/// the name SEND_RECEIVE, which say what ranks of an older SU2 exchange. What SU2 keeps in the same file beside the
/// mesh (boxes for free-form deformation) is passed over.
///
/// Collective; every rank reads its share. Throws the same `Error` on every rank, with the line, for what is no such
/// file, for several zones, two dimensions, and what `mesh_of_elements` refuses.
ElementMesh read_su2(const par::Comm& comm, const std::filesystem::path& file, const ElementOptions& options = {});

}  // namespace pamr::io
