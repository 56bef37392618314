// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/borders.hpp"

#include <algorithm>
#include <tuple>

#include "pamr/mesh/ring.hpp"

namespace pamr::mesh {

namespace {

struct Arc {
  par::SharedKey key;
  CellEdge lowest;
};

/// One entry for each arc of an edge at which this rank's part ends at a rank border.
std::vector<Arc> find_arcs(const DistMesh& mesh) {
  std::vector<Arc> arcs;
  for (const auto face : mesh.border_face)
    for (int e = 0; e < tet::n_edges; ++e) {
      if ((tet::face_edge_mask[static_cast<std::size_t>(face.slot)] >> e & 1) == 0) continue;
      CellEdge lowest{face.cell, e};
      walk_ring(mesh, face.cell, e, [&](LocalId cell, int edge) {
        if (cell < lowest.cell) lowest = {cell, edge};
      });
      const auto& nodes = mesh.cell_to_node[static_cast<std::size_t>(lowest.cell)];
      const auto [p, q] = tet::edge_to_corner[static_cast<std::size_t>(lowest.edge)];
      const auto a = mesh.node_global[static_cast<std::size_t>(nodes[static_cast<std::size_t>(p)])];
      const auto b = mesh.node_global[static_cast<std::size_t>(nodes[static_cast<std::size_t>(q)])];
      arcs.push_back({{std::min(a, b), std::max(a, b), -1}, lowest});
    }
  const auto order = [](const Arc& arc) { return std::tie(arc.key, arc.lowest.cell); };
  std::sort(arcs.begin(), arcs.end(), [&](const Arc& a, const Arc& b) { return order(a) < order(b); });
  arcs.erase(std::unique(arcs.begin(), arcs.end(), [&](const Arc& a, const Arc& b) { return order(a) == order(b); }),
             arcs.end());
  return arcs;
}

/// Nodes of rank-border and boundary faces, without repeats.
std::vector<LocalId> outer_nodes(const DistMesh& mesh) {
  std::vector<LocalId> nodes;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int f = 0; f < 4; ++f)
      if (!mesh.is_own(mesh.cell_to_cell[static_cast<std::size_t>(c)][static_cast<std::size_t>(f)]))
        for (const auto corner : tet::face_to_corner[static_cast<std::size_t>(f)])
          nodes.push_back(mesh.cell_to_node[static_cast<std::size_t>(c)][static_cast<std::size_t>(corner)]);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

}  // namespace

Borders find_borders(const par::Comm& comm, const DistMesh& mesh) {
  Borders borders;
  std::vector<par::SharedKey> key;
  const auto arcs = find_arcs(mesh);
  for (const auto& arc : arcs) {
    if (key.empty() || key.back() != arc.key) {
      key.push_back(arc.key);
      borders.arc_offset.push_back(borders.arc.size());
    }
    borders.arc.push_back(arc.lowest);
    borders.arc_offset.back() = borders.arc.size();
  }
  borders.edges = par::find_shared(comm, key);

  if (comm.size() > 1) {
    const auto outer = outer_nodes(mesh);
    key.clear();
    for (const auto node : outer) key.push_back({mesh.node_global[static_cast<std::size_t>(node)], -1, -1});
    borders.nodes = par::find_shared(comm, key);
    for (auto& item : borders.nodes.item) item = outer[static_cast<std::size_t>(item)];
  }

  borders.faces.rank = mesh.border_rank;
  borders.faces.offset = mesh.border_offset;
  for (std::size_t k = 0; k < mesh.border_face.size(); ++k) borders.faces.item.push_back(static_cast<LocalId>(k));
  return borders;
}

}  // namespace pamr::mesh
