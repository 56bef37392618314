// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/patch_list.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/closure.hpp"

namespace pamr::refine {

/// A new node on the boundary or on a surface inside.
struct BoundaryNode {
  LocalId new_node = 0;
  /// Patches of the two boundary faces at its edge, and those with a surface of faces inside at it, without repeats.
  mesh::PatchList patch{-1, -1, -1, -1};
};

/// New nodes and the global numbers of everything new. New node i has local id `n_old_nodes` + i in the refined mesh.
struct Numbering {
  LocalId n_old_nodes = 0;                           ///< on this rank
  std::vector<LocalId> row;                          ///< n_cells: row of `edge_to_node`, -1: no marks
  std::vector<std::array<LocalId, 6>> edge_to_node;  ///< local ids of the midpoints of a marked cell's edges
  std::vector<std::array<LocalId, 2>> ends;          ///< per new node: the nodes at the ends of its edge
  std::vector<GlobalId> node_global;                 ///< per new node
  std::vector<BoundaryNode> boundary;                ///< ascending in `new_node`
  std::vector<LocalId> first_child;                  ///< n_cells + 1: local ids of the children of each old cell
  std::vector<GlobalId> first_child_global;          ///< n_cells
  GlobalId n_global_nodes = 0;
  GlobalId n_global_cells = 0;

  std::size_t n_new_nodes() const { return ends.size(); }
  /// Frees what is of no use once children and nodes are made: all but `ends` and `first_child`.
  void drop_all_but_children() {
    free_array(row);
    free_array(edge_to_node);
    free_array(node_global);
    free_array(boundary);
    free_array(first_child_global);
  }
  LocalId midpoint(LocalId cell, int edge) const { return edge_to_node[at(row[at(cell)])][at(edge)]; }
};

/// A mesh whose marked edges have new nodes and whose children have numbers: what the steps read that make the refined
/// mesh of it. Only references.
struct NumberedMesh {
  const mesh::DistMesh& mesh;
  const Closure& closure;
  const Numbering& numbering;
};

/// Makes one node on every marked edge and numbers nodes and children so that nothing depends on the partition: old
/// nodes keep their numbers; a new node belongs to the lowest old cell at its edge, and new nodes follow in the order
/// of those cells, then of the edge's number there; children follow their parents in the old order (those of a family
/// that was taken back follow its first member), template by template. Collective: exchanges over the border edges, and
/// scans in block distribution (O(cells / ranks) bytes a rank; one exclusive sum where each rank holds one run of cell
/// numbers). No host, no sort. Cost: one ring walk a marked edge.
Numbering number(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                 const Closure& closure);

}  // namespace pamr::refine
