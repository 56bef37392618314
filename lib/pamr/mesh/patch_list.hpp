// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <map>

#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

inline constexpr int max_node_patches = 4;

/// Patches at a node, ascending, -1 where there are no more.
using PatchList = std::array<int, max_node_patches>;

/// Adds a patch to a list without repeats; a fifth patch at one node is dropped.
void add_patch(PatchList& list, int patch);

/// Adds to each list the patches of the boundary at its node, and those with a surface of faces inside, those of faces on
/// other ranks too. Nodes that several ranks hold are to
/// be asked for on all of them. Collective: one neighbor exchange of the shared nodes. Cost: O(cells).
void add_patches_of_nodes(const par::Comm& comm, const DistMesh& mesh, const Borders& borders,
                          std::map<LocalId, PatchList>& patches);

}  // namespace pamr::mesh
