// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/fine_nodes.hpp"

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"

namespace pamr::refine {

namespace {

std::vector<geometry::Vec3> join_positions(const NumberedMesh& old, const std::vector<Movable>& movables) {
  const auto& [mesh, closure, numbering] = old;
  std::vector<geometry::Vec3> position;
  reserve_array(position, at(mesh.n_nodes()) + numbering.n_new_nodes());
  position = mesh.node_position;
  for (const auto [a, b] : numbering.ends) position.push_back(geometry::midpoint(mesh.point(a), mesh.point(b)));
  for (const auto& movable : movables) position[at(movable.node)] = movable.target;
  return position;
}

std::vector<GlobalId> join_ids(const NumberedMesh& old) {
  std::vector<GlobalId> ids;
  reserve_array(ids, old.mesh.node_global.size() + old.numbering.n_new_nodes());
  ids = old.mesh.node_global;
  ids.insert(ids.end(), old.numbering.node_global.begin(), old.numbering.node_global.end());
  return ids;
}

/// Adds the old nodes that are shared with neighbor `i` of their pattern.
void add_old_nodes(const par::Pattern& nodes, std::size_t i, std::vector<LocalId>& item) {
  item.insert(item.end(), nodes.item.begin() + static_cast<std::ptrdiff_t>(nodes.offset[i]),
              nodes.item.begin() + static_cast<std::ptrdiff_t>(nodes.offset[i + 1]));
}

/// Adds the new nodes on the border edges that are shared with neighbor `j` of their pattern.
void add_new_nodes(const NumberedMesh& old, const mesh::Borders& borders, std::size_t j, std::vector<LocalId>& item) {
  for (auto k = borders.edges.offset[j]; k < borders.edges.offset[j + 1]; ++k) {
    const auto arc = borders.arcs(at(borders.edges.item[k])).front();
    if ((old.closure.marks[at(arc.cell)] >> arc.edge & 1) != 0)
      item.push_back(old.numbering.midpoint(arc.cell, arc.edge));
  }
}

/// The old nodes and those on marked border edges, by neighbor: both sides list them in the same order.
par::Pattern share_nodes(const NumberedMesh& old, const mesh::Borders& borders) {
  par::Pattern shared;
  const auto &node_rank = borders.nodes.rank, &edge_rank = borders.edges.rank;
  for (std::size_t i = 0, j = 0; i < node_rank.size() || j < edge_rank.size();) {
    const bool nodes_come_first = j == edge_rank.size() || (i < node_rank.size() && node_rank[i] <= edge_rank[j]);
    const Rank rank = nodes_come_first ? node_rank[i] : edge_rank[j];
    if (nodes_come_first) add_old_nodes(borders.nodes, i++, shared.item);
    if (j < edge_rank.size() && edge_rank[j] == rank) add_new_nodes(old, borders, j++, shared.item);
    shared.rank.push_back(rank);
    shared.offset.push_back(shared.item.size());
  }
  return shared;
}

}  // namespace

FineNodes place_nodes(const NumberedMesh& old, const mesh::Borders& borders, const std::vector<Movable>& movables) {
  return {join_positions(old, movables), join_ids(old), share_nodes(old, borders)};
}

}  // namespace pamr::refine
