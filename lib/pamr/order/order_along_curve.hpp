// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/mesh/block_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::order {

/// Counts that say how far numbers stray from the places of cells in space; the same on any number of ranks.
///
/// A *link* goes from a cell to a neighbor; it is far where the two numbers differ by more than 2^13 (the cells
/// between them fill a good part of a second-level cache). A *corner* is lonely where its node's number differs by more
/// than 2^11 from those of the cell's other three nodes. Where a mesh has no neighbors yet, a link goes from a cell to
/// the next one, and is far where the two share no node. Meshes of at most 2^15 cells have no links and no corners that
/// count: a cache holds them in any order.
///
/// Measured: in random order nine in ten links are far and eight in ten corners lonely; on lexicographic cubes the
/// links of one direction (1/6) and 1/6 of the corners; along a curve 3 %; on refined meshes, where old nodes and new
/// ones meet in a cell, up to 8 % and 21 %. A mesh that was refined in random order keeps a part of it: 47 % and 55 %
/// after one uniform refinement, 24 % and 43 % after two.
struct Disorder {
  std::int64_t links = 0, far_links = 0;
  std::int64_t corners = 0, lonely_corners = 0;

  /// At most a quarter of the links far and half of the corners lonely.
  bool is_small() const { return 4 * far_links <= links && 2 * lonely_corners <= corners; }
};

/// Collective: one reduction (without neighbors four gathers of one number a rank in addition). Numbers out of range
/// count as far. Cost: one pass over the cells.
Disorder measure_disorder(const par::Comm& comm, const mesh::BlockMesh& block);

/// True where ordering would gain little. Collective.
inline bool is_ordered(const par::Comm& comm, const mesh::BlockMesh& block) {
  return measure_disorder(comm, block).is_small();
}

/// A renumbered mesh, and where its parts come from.
struct Ordered {
  mesh::BlockMesh block;              ///< cells in canonical blocks
  std::vector<GlobalId> cell_origin;  ///< for each cell of the block its number before
  std::vector<GlobalId> node_origin;  ///< for each node of the block its number before
};

/// The same mesh with its cells along Hilbert's curve through their centroids, over the smallest cube that holds all
/// nodes, and its nodes in the order in which the cells name them first: what lies close in space lies close in memory,
/// in the file, and in a block of it. Corners, neighbors, boundary triangles, patches, lineage, origins and fields go
/// along. A tree (a cell of level 0 and all that was split of it, closure families included) stays together in its
/// order, where its first cell lies, so that splits can be undone; cells of equal place keep their order; nodes that no
/// cell names come last.
///
/// Collective; on one rank nothing is sent. The new numbers do not depend on the number of ranks nor on the blocks.
/// Throws `Error` on every rank for what `assemble` refuses of a single block: numbers out of range, lineage that does
/// not describe families, sizes that do not fit. Coordinates are not looked at: what is not finite gets some place.
/// Cost: O(cells) time; over ranks every cell is sent once, O(cells / ranks) bytes a rank, beside some 25 reductions of
/// 16 numbers a rank.
Ordered order_along_curve(const par::Comm& comm, mesh::BlockMesh block);

}  // namespace pamr::order
