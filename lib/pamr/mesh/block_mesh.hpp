// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::mesh {

/// Triangles of the boundary or inside with the patch of each, as many solvers hold it: any number on each rank, in any order,
/// the corners of each in any order.
struct BoundaryTriangles {
  std::vector<std::array<GlobalId, 3>> node;  ///< t x 3, global
  std::vector<int> patch;                     ///< t, indices into `MeshInfo::patches`
};

/// One rank's share of a mesh as it lies in a file: cells `first_cell ..` in global order with global numbers (the
/// first of all is `info.first_id`), and the canonical block (`par::block_range`) of the nodes.
struct BlockMesh {
  MeshInfo info;
  GlobalId first_cell = 0;
  std::vector<std::array<GlobalId, 4>> cell_to_node;  ///< n x 4, global
  std::vector<std::array<GlobalId, 4>> cell_to_cell;  ///< n x 4, global or -(patch+1); empty on every rank: to be built
  /// Which patches faces of the boundary and inner faces belong to, where neighbors are to be built; faces of the
  /// boundary without a triangle then get the patch of kind `untagged` (`mesh/untagged_patch.hpp`). Beside neighbors it
  /// has to agree with them. Empty on every rank: see `assemble::assemble`.
  BoundaryTriangles boundary;
  std::vector<Lineage> lineage;               ///< n, or empty on every rank: all regular, level 0
  std::vector<GlobalId> cell_origin;          ///< n: numbers in the file; empty on every rank: as they lie here
  std::vector<geometry::Vec3> node_position;  ///< canonical block of n_global_nodes
  std::vector<CellField> cell_fields;         ///< values of the n cells
  std::vector<NodeField> node_fields;         ///< values of the node block
};

}  // namespace pamr::mesh
