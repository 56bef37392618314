// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::mesh {

/// An edge of a cell.
struct CellEdge {
  LocalId cell = invalid_local;
  int edge = 0;
};

/// What the ranks of a distributed mesh share in addition to faces. Built once for each mesh.
struct Borders {
  /// Border edges: `edges.item` counts them from 0. A rank may hold several arcs of the ring of one edge;
  /// `arc[arc_offset[i] .. arc_offset[i+1])` names one cell of each.
  par::Pattern edges;
  std::vector<std::size_t> arc_offset{0};
  std::vector<CellEdge> arc;
  /// Nodes on rank borders and on the boundary that other ranks hold too; `nodes.item` are local nodes.
  par::Pattern nodes;
  /// Rank-border faces; slot k is `mesh.border_face[k]`.
  par::Pattern faces;

  std::size_t n_edges() const { return arc_offset.size() - 1; }
  std::span<const CellEdge> arcs(std::size_t edge) const {
    return std::span<const CellEdge>(arc).subspan(arc_offset[edge], arc_offset[edge + 1] - arc_offset[edge]);
  }
};

/// Finds them, by sharing of nodes: two ranks may meet in an edge without a common face.
/// Collective: three sparse exchanges. Cost proportional to the rank border and to the boundary of this rank's part.
Borders find_borders(const par::Comm& comm, const DistMesh& mesh);

}  // namespace pamr::mesh
