// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "pamr/io/formats.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

/// Parts of a mesh that a format cannot store.
namespace pamr::io {

/// One sentence each for conditions, fields, names and the like, and faces inside. None where nobody is to hear of it
/// (`options.remark`), nor for surfaces, which hold the boundary alone. Collective.
std::vector<std::string> texts_of_losses(const par::Comm& comm, const Format& format, const mesh::DistMesh& mesh,
                                         const MeshWriteOptions& options);

/// One sentence for boundary faces without a tag where the format has none: they are in a patch like others; empty
/// where there are none. Collective.
std::string text_of_named_faces(const par::Comm& comm, const Format& format, const mesh::DistMesh& mesh);

/// One sentence for levels, surfaces, numbers of patches and the unit of lengths; empty where there are none, and for
/// the native format. Collective.
std::string text_of_lost_history(const par::Comm& comm, const Format& format, const mesh::DistMesh& mesh);

}  // namespace pamr::io
