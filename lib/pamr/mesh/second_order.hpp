// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/geometry/quadratic_tet.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/field.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::mesh {

/// What makes the cells of a mesh cells of second order: a node on every edge. The nodes of the mesh come first, with
/// their local ids and global numbers; the mid-edge nodes follow in both. Ranks that share an edge all hold its node,
/// with the same number and the same bits of its position.
struct SecondOrder {
  std::vector<geometry::Vec3> node_position;        ///< n_nodes of the mesh, then the mid-edge nodes; length unit
  std::vector<GlobalId> node_global;                ///< the same
  std::vector<std::array<LocalId, 6>> cell_to_mid;  ///< n_cells x 6: mid-edge nodes, edges as in `mesh/tet.hpp`
  /// The node fields of the mesh on all nodes; with `off_surface` (`mesh/field.hpp`) where a node is off its surface.
  std::vector<NodeField> node_fields;
  par::Pattern shared;  ///< all nodes that other ranks hold too
  GlobalId n_global_nodes = 0;

  IdRange node_ids(const MeshInfo& info) const { return {n_global_nodes, info.first_id}; }
};

/// The ten nodes of a cell.
geometry::QuadraticTet quadratic_tet(const DistMesh& mesh, const SecondOrder& second_order, LocalId cell);

}  // namespace pamr::mesh
