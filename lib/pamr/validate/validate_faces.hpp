// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::validate {

/// True when `check_own_neighbors` would find nothing: the same said without saying where it is broken, which is all
/// that a sound mesh asks for, three times faster. Local; 16 bytes a cell and 8 a node.
bool own_faces_match(const mesh::DistMesh& mesh);

}  // namespace pamr::validate
