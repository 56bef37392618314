// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "meshing/repair/split_cells.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::meshing {

/// A node that may move. Those of the old mesh do so only where cells at them are poor.
struct MovableNode {
  GlobalId node = 0;
  geometry::Vec3 point;
  bool is_new = true;
};

/// Where the nodes are best placed: each in turn goes where the smallest mean ratio is largest, until none moves. That
/// is the ratio of the cells at it, and of those with a face on a curved wall as they will be after many levels. No
/// cell is inverted, and none that is better than 0.2 gets below that.
/// `parts` are all cells at the nodes and no node of theirs that is not listed moves. Local; the same for the same
/// input.
std::vector<MovableNode> improve_nodes(const mesh::MeshInfo& info, std::vector<MovableNode> nodes,
                                       const std::vector<CellPart>& parts);

}  // namespace pamr::meshing
