// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/fine_nodes.hpp"
#include "pamr/refine/movable.hpp"
#include "pamr/refine/number.hpp"

namespace pamr::curved {

/// A node in each edge of a mesh, numbered after its nodes.
struct EdgeNodes {
  mesh::MeshInfo info;  ///< of the mesh; patches that lie in a plane have it
  refine::Closure closure;
  refine::Numbering numbering;            ///< `edge_to_node`: rows are cells
  std::vector<refine::Movable> movables;  ///< edges in curved walls: where their nodes belong, ascending
  refine::FineNodes placed;               ///< all nodes, those of `movables` where they belong
};

/// Places new nodes in the middles of all edges exactly where a refinement would put them. Corners stay where they are.
/// Collective: as numbering and projecting in a refinement.
EdgeNodes place_edge_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders);

}  // namespace pamr::curved
