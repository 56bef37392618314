// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/curved/level0_edges.hpp"

#include "pamr/par/exchange.hpp"

namespace pamr::curved {

namespace {

using geometry::Vec3;

constexpr double no_bulge = 1e-9;  ///< of its edge

}  // namespace

Level0Edges look_at_edges(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders) {
  Level0Edges edges{comm, mesh, borders, place_edge_nodes(comm, mesh, borders), {}, {}, {}};
  const auto n = edges.n_edges();
  edges.movable.assign(n, -1);
  edges.bulge.assign(n, Vec3{});
  edges.is_coarse.assign(n, 0);
  const auto& movables = edges.nodes.movables;
  for (std::size_t i = 0; i < movables.size(); ++i) {
    const auto edge = at(movables[i].node - mesh.n_nodes());
    edges.movable[edge] = static_cast<LocalId>(i);
    const auto [a, b] = edges.ends(edge);
    const double length = norm(mesh.point(b) - mesh.point(a));
    const auto bulge = movables[i].target - movables[i].base;
    if (norm(bulge) > no_bulge * length) edges.bulge[edge] = bulge;
    edges.is_coarse[edge] = norm(bulge) > coarse_bulge * length ? 1 : 0;
  }
  return edges;
}

std::vector<std::size_t> own_coarse_edges(const Level0Edges& edges) {
  const auto& placed = edges.nodes.placed;
  const auto is_mine = par::held_first_here(par::Exchange(edges.comm, placed.shared), placed.position.size());
  std::vector<std::size_t> own;
  for (std::size_t e = 0; e < edges.n_edges(); ++e)
    if (edges.is_coarse[e] != 0 && is_mine[at(edges.mesh.n_nodes()) + e] != 0) own.push_back(e);
  return own;
}

}  // namespace pamr::curved
