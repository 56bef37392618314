// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::balance {

/// This rank's cells in groups that stay together: group `i` holds cells `cell[offset[i] .. offset[i+1])`. Every cell
/// is in one group; the members of a closure family are in the same one.
struct Groups {
  std::vector<std::size_t> offset{0};
  std::vector<LocalId> cell;  ///< n_cells

  std::size_t size() const { return offset.size() - 1; }
  std::span<const LocalId> cells(std::size_t group) const {
    return std::span<const LocalId>(cell).subspan(offset[group], offset[group + 1] - offset[group]);
  }
};

/// One group for each whole closure family and for each other cell, in the order of the cells. Local.
Groups group_families(const mesh::DistMesh& mesh);

/// Groups of cells that lie together and weigh about `weight_of_group`: runs along Hilbert's curve through the
/// centroids of this rank's cells, whatever the order of the cells. Whole families count as one cell. Makes the graph
/// small enough for the partitioner to cost less than the refinement. Local; O(cells). `cell_weight`: n_cells.
Groups group_by_weight(const mesh::DistMesh& mesh, std::span<const std::int64_t> cell_weight,
                       std::int64_t weight_of_group);

/// The graph whose vertices are groups of cells and whose arcs are pairs of groups that share faces, distributed as the
/// cells are. Vertices are numbered over the ranks, rank after rank: local vertex `i` is `first_vertex + i`. Parallel
/// arcs are merged; every arc is listed at both ends with the same weight; a vertex is not its own neighbor.
struct DualGraph {
  GlobalId first_vertex = 0;
  GlobalId n_global_vertices = 0;
  std::vector<std::int64_t> weight;     ///< n_vertices: sum over the cells
  std::vector<std::int64_t> arc_begin;  ///< n_vertices + 1
  std::vector<GlobalId> neighbor;       ///< arcs of vertex i: arc_begin[i] .. arc_begin[i+1]
  std::vector<std::int64_t> n_faces;    ///< of each arc

  std::size_t n_vertices() const { return weight.size(); }
};

/// Builds it. Collective: one exclusive sum, one sum, one neighbor exchange of 8 bytes a rank-border face. Order of
/// the arcs: as the faces are met. Cost: O(cells) time, 8 bytes a cell in addition to the result.
DualGraph build_dual_graph(const par::Comm& comm, const mesh::DistMesh& mesh, const Groups& groups,
                           std::span<const std::int64_t> cell_weight);

}  // namespace pamr::balance
