// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "meshing/raw_mesh.hpp"

namespace pamr::meshing {

/// The same mesh with its cells along Hilbert's curve by centroid and its nodes in the order in which the cells name
/// them, so that neighbors in space are neighbors in the file and in a block of it. Local, deterministic.
RawMesh ordered(const RawMesh& mesh);

}  // namespace pamr::meshing
