// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/borders.hpp"

#include <algorithm>
#include <tuple>

#include "pamr/mesh/ring.hpp"
#include "pamr/mesh/sorted_order.hpp"

namespace pamr::mesh {

namespace {

struct Arc {
  GlobalId a = 0, b = 0;  ///< ends of the edge, a < b
  CellEdge lowest;
};

/// Bits of the edges of rank-border faces, by edge number in the face's cell.
class FaceEdges {
 public:
  explicit FaceEdges(const DistMesh& mesh) : mesh_(&mesh), seen_(mesh.border_face.size(), 0) {}
  bool is_seen(std::size_t face, int edge) const { return (seen_[face] >> edge & 1) != 0; }
  /// `slot`: a neighbour slot at which a walk round the edge from node `a` to node `b` ended.
  void see(LocalId slot, LocalId a, LocalId b) {
    if (!mesh_->is_ghost(slot)) return;
    const auto face = static_cast<std::size_t>(slot - mesh_->n_cells());
    const auto& nodes = mesh_->cell_to_node[static_cast<std::size_t>(mesh_->border_face[face].cell)];
    const auto edge =
        tet::edge_of[static_cast<std::size_t>(slot_of(nodes, a))][static_cast<std::size_t>(slot_of(nodes, b))];
    seen_[face] = static_cast<std::uint8_t>(seen_[face] | 1U << static_cast<unsigned>(edge));
  }

 private:
  const DistMesh* mesh_;
  std::vector<std::uint8_t> seen_;
};

/// One entry for each arc of an edge at which this rank's part ends at a rank border, by edge and lowest cell. An arc
/// has two ends: it is walked from the first that comes.
std::vector<Arc> find_arcs(const DistMesh& mesh) {
  std::vector<Arc> arcs;
  arcs.reserve(2 * mesh.border_face.size());
  FaceEdges ends(mesh);
  for (std::size_t k = 0; k < mesh.border_face.size(); ++k) {
    const auto face = mesh.border_face[k];
    const auto& nodes = mesh.cell_to_node[static_cast<std::size_t>(face.cell)];
    for (int e = 0; e < tet::n_edges; ++e) {
      if ((tet::face_edge_mask[static_cast<std::size_t>(face.slot)] >> e & 1) == 0 || ends.is_seen(k, e)) continue;
      CellEdge lowest{face.cell, e};
      const auto end = walk_ring(mesh, face.cell, e, [&](LocalId cell, int edge) {
        if (cell < lowest.cell) lowest = {cell, edge};
      });
      const auto [p, q] = tet::edge_to_corner[static_cast<std::size_t>(e)];
      const auto a = nodes[static_cast<std::size_t>(p)], b = nodes[static_cast<std::size_t>(q)];
      ends.see(end.first, a, b);
      ends.see(end.second, a, b);
      const auto id_a = mesh.node_global[static_cast<std::size_t>(a)];
      const auto id_b = mesh.node_global[static_cast<std::size_t>(b)];
      arcs.push_back({std::min(id_a, id_b), std::max(id_a, id_b), lowest});
    }
  }
  std::vector<std::uint64_t> leading;
  leading.reserve(arcs.size());
  for (const auto& arc : arcs) leading.push_back(static_cast<std::uint64_t>(arc.a - mesh.info.first_id));
  std::vector<Arc> sorted;
  sorted.reserve(arcs.size());
  const auto order = sorted_order(leading, [&](std::uint32_t x, std::uint32_t y) {
    return std::tie(arcs[x].b, arcs[x].lowest.cell) < std::tie(arcs[y].b, arcs[y].lowest.cell);
  });
  for (const auto i : order) sorted.push_back(arcs[i]);
  return sorted;
}

/// Nodes of rank-border and boundary faces, ascending.
std::vector<LocalId> outer_nodes(const DistMesh& mesh) {
  std::vector<std::uint8_t> is_outer(mesh.node_global.size(), 0);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int f = 0; f < 4; ++f)
      if (!mesh.is_own(mesh.cell_to_cell[static_cast<std::size_t>(c)][static_cast<std::size_t>(f)]))
        for (const auto corner : tet::face_to_corner[static_cast<std::size_t>(f)])
          is_outer[static_cast<std::size_t>(
              mesh.cell_to_node[static_cast<std::size_t>(c)][static_cast<std::size_t>(corner)])] = 1;
  std::vector<LocalId> nodes;
  for (std::size_t n = 0; n < is_outer.size(); ++n)
    if (is_outer[n] != 0) nodes.push_back(static_cast<LocalId>(n));
  return nodes;
}

}  // namespace

Borders find_borders(const par::Comm& comm, const DistMesh& mesh) {
  Borders borders;
  std::vector<par::SharedKey> key;
  const auto arcs = find_arcs(mesh);
  for (const auto& arc : arcs) {
    const par::SharedKey edge{arc.a, arc.b, -1};
    if (key.empty() || key.back() != edge) {
      key.push_back(edge);
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
