// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

#include "pamr/base/exact.hpp"
#include "pamr/base/prefetch.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::mesh {

/// Where a walk around an edge ended: nowhere (`is_closed`), or at two neighbor slots that are no own cells (patches or
/// face ghosts).
struct RingEnds {
  bool is_closed = true;
  LocalId first = 0;
  LocalId second = 0;
};

/// Slot of a node in a cell that holds it, without branches.
constexpr int slot_of(const CellNodes& nodes, Exact<LocalId> node) {
  return static_cast<int>(nodes[1] == node) + 2 * static_cast<int>(nodes[2] == node) +
         3 * static_cast<int>(nodes[3] == node);
}

namespace detail {

/// The face of a cell opposite corner `leave`; it holds the edge that is walked around, and `pivot`.
struct WayOut {
  LocalId cell;
  int leave;
  LocalId pivot;
};

/// Walks around the edge (a, b) until the ring closes or ends. Returns the slot at its end, or the first cell when it
/// closed.
template <class Visit>
LocalId walk_one_way(const DistMesh& mesh, LocalId a, LocalId b, WayOut from, Visit& visit) {
  auto [cell, leave, pivot] = from;
  const LocalId start = cell;
  for (;;) {
    const LocalId next = mesh.cell_to_cell[static_cast<std::size_t>(cell)][static_cast<std::size_t>(leave)];
    if (next == start || !mesh.is_own(next)) return next;
    prefetch(&mesh.cell_to_cell[static_cast<std::size_t>(next)]);  // while the nodes are on their way
    const auto& nodes = mesh.cell_to_node[static_cast<std::size_t>(next)];
    const int slot_a = slot_of(nodes, a), slot_b = slot_of(nodes, b), slot_pivot = slot_of(nodes, pivot);
    visit(next, tet::edge_of[static_cast<std::size_t>(slot_a)][static_cast<std::size_t>(slot_b)]);
    leave = slot_pivot;
    pivot = nodes[static_cast<std::size_t>(6 - slot_a - slot_b - slot_pivot)];
    cell = next;
  }
}

}  // namespace detail

/// Calls `visit(cell, edge)` for every own cell around the edge `edge` of `start`, `start` first, each with the edge's
/// number in that cell: the cells of an edge found through the cell neighbors, without edge arrays. Local. Where the
/// ring is cut by the boundary or a rank border, the cells joined to `start` by own faces at the edge are visited.
/// Cost: about five cells an edge. Source: the method of DSMC-driven parallel adaptive mesh refinement (PAMR),
/// section 2.1.2.
template <class Visit>
RingEnds walk_ring(const DistMesh& mesh, Exact<LocalId> start, Exact<int> edge, Visit&& visit) {
  const auto& nodes = mesh.cell_to_node[static_cast<std::size_t>(start)];
  const auto [corner_a, corner_b] = tet::edge_to_corner[static_cast<std::size_t>(edge)];
  const auto [corner_p, corner_q] = tet::edge_to_corner[static_cast<std::size_t>(tet::opposite_edge(edge))];
  const LocalId a = nodes[static_cast<std::size_t>(corner_a)], b = nodes[static_cast<std::size_t>(corner_b)];
  visit(start, edge);
  const LocalId first =
      detail::walk_one_way(mesh, a, b, {start, corner_p, nodes[static_cast<std::size_t>(corner_q)]}, visit);
  if (first == start) return {};
  const LocalId second =
      detail::walk_one_way(mesh, a, b, {start, corner_q, nodes[static_cast<std::size_t>(corner_p)]}, visit);
  return {false, first, second};
}

}  // namespace pamr::mesh
