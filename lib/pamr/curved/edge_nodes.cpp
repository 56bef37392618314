// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/curved/edge_nodes.hpp"

#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "pamr/refine/project.hpp"
#include "pamr/refine/split_pattern.hpp"

namespace pamr::curved {

namespace {

/// Every cell with all its edges marked: then numbering gives each edge of the mesh a node.
refine::Closure mark_every_edge(const mesh::DistMesh& mesh) {
  refine::Closure closure;
  const auto n = at(mesh.n_cells());
  assign_array(closure.marks, n, refine::all_edges);
  assign_array(closure.action, n, refine::Action::split);
  assign_array(closure.state, n, static_cast<refine::SplitState>(refine::regular_state));
  return closure;
}

}  // namespace

EdgeNodes place_edge_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders) {
  EdgeNodes edges;
  edges.info = mesh::with_planes(mesh.info, mesh::find_undescribed_patches(comm, mesh, borders));
  edges.closure = mark_every_edge(mesh);
  edges.numbering = refine::number(comm, mesh, borders, edges.closure);
  edges.movables = refine::project(comm, mesh, borders, edges.numbering, {edges.info, *edges.info.surfaces});
  std::erase_if(edges.movables, [&](const auto& m) { return m.node < mesh.n_nodes(); });
  edges.placed = refine::place_nodes({mesh, edges.closure, edges.numbering}, borders, edges.movables);
  return edges;
}

}  // namespace pamr::curved
