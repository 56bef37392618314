// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/session.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::tools {

/// Before a refinement: gives flat patches that meet others their planes, and says which other patches will be bent.
/// Collective.
void keep_flat_patches(cli::Session& session, mesh::DistMesh& mesh);

}  // namespace pamr::tools
