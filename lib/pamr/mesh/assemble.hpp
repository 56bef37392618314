// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

/// One rank's share of a mesh as it lies in a file: cells `first_cell ..` in global order with global numbers (the
/// first of all is `info.first_id`), and the canonical block (`par::block_range`) of the nodes.
struct BlockMesh {
  MeshInfo info;
  GlobalId first_cell = 0;
  std::vector<std::array<GlobalId, 4>> cell_to_node;  ///< n x 4, global
  std::vector<std::array<GlobalId, 4>> cell_to_cell;  ///< n x 4, global or -(patch+1); empty on every rank: to be built
  std::vector<Lineage> lineage;                       ///< n, or empty on every rank: all regular, level 0
  std::vector<geometry::Vec3> node_position;          ///< canonical block of n_global_nodes
  std::vector<CellField> cell_fields;                 ///< values of the n cells
  std::vector<NodeField> node_fields;                 ///< values of the node block
};

/// Builds the distributed mesh: sends every cell to `destination[i]` (empty on every rank: stay) together with its
/// fields, moves whole families to the destination of their first member, fetches the nodes, builds neighbours where
/// the blocks have none (every boundary face then gets patch 0, and a patch `boundary` is made where there is none),
/// and lists rank-border faces. Local nodes are numbered in order of first use by the cells. Collective: a sparse
/// exchange for each 2^17 cells that leave a rank, a few proportional to the nodes, to the rank border and to the cells
/// sent (their directory); without destinations nothing is sent of the cells but families cut by a block border. Throws
/// `Error` on every rank for node, cell or patch numbers out of range, a node twice in a cell, a face in three cells, a
/// neighbour that is not reciprocal, families that are not whole, contiguous and in template order, blocks or fields
/// whose sizes do not fit. Does not look at coordinates. Cost: O(cells + nodes) time; where neighbours are built
/// O(cells log(faces at a node)).
DistMesh assemble(const par::Comm& comm, BlockMesh block, std::span<const Rank> destination = {});

}  // namespace pamr::mesh
