// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/curved/off_walls.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/field.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::curved {

namespace {

constexpr double on_wall = 1e-6;  ///< of an edge: a sixtieth of an edge of level 14
constexpr double far_off = 0.01;  ///< of an edge; from 1/40 on it would seem to be curvature

/// Nodes on curved walls: the shortest edge of a boundary face there and the distance from the farthest surface.
struct WallNodes {
  std::vector<double> edge, distance;
  std::vector<std::uint8_t> is_held;  ///< by a patch without a surface, whose faces would bend
};

/// Collective.
WallNodes measure(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders) {
  WallNodes nodes;
  nodes.edge.assign(at(mesh.n_nodes()), std::numeric_limits<double>::infinity());
  nodes.distance.assign(at(mesh.n_nodes()), 0.0);
  nodes.is_held.assign(at(mesh.n_nodes()), 0);
  const auto info = mesh::with_planes(mesh.info, mesh::find_undescribed_patches(comm, mesh, borders));
  const mesh::InnerPatches patches(mesh);
  std::vector<int> measured(at(mesh.n_nodes()), -1);  // the patch of the last face that asked
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const int patch = patches.of_any({c, static_cast<int>(f)});
      if (patch < 0) continue;
      const auto* surface = info.surface_of(patch);
      if (surface == nullptr && mesh.cell_to_cell[at(c)][f] >= 0) continue;
      const auto& corner = mesh::tet::face_to_corner[f];
      if (surface == nullptr)
        for (const auto k : corner) nodes.is_held[at(mesh.cell_to_node[at(c)][at(k)])] = 1;
      if (surface == nullptr || surface->is_flat()) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto a = mesh.cell_to_node[at(c)][at(corner[k])], b = mesh.cell_to_node[at(c)][at(corner[(k + 1) % 3])];
        const double length = norm(mesh.point(b) - mesh.point(a));
        for (const auto node : {a, b}) nodes.edge[at(node)] = std::min(nodes.edge[at(node)], length);
        if (std::exchange(measured[at(a)], patch) == patch) continue;
        nodes.distance[at(a)] = std::max(nodes.distance[at(a)], surface->distance(mesh.point(a)));
      }
    }
  const par::Exchange exchange(comm, borders.nodes);
  par::fold_shared(exchange, nodes.edge, [](double& mine, double theirs) { mine = std::min(mine, theirs); });
  par::fold_shared(exchange, nodes.distance, [](double& mine, double theirs) { mine = std::max(mine, theirs); });
  par::fold_flags(exchange, nodes.is_held);
  return nodes;
}

}  // namespace

NodesOffWalls find_nodes_off_walls(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders) {
  const auto* field = mesh.find_node_field(mesh::off_surface_field);
  const bool is_recorded = field != nullptr && !field->holds_integers();
  const auto nodes = measure(comm, mesh, borders);
  NodesOffWalls found;
  found.off = is_recorded ? field->real() : std::vector<double>(at(mesh.n_nodes()), 0.0);
  bool any_is_off = false, any_stays = false;
  for (std::size_t n = 0; n < found.off.size(); ++n) {
    auto& off = found.off[n];
    const double distance = std::max(off, nodes.distance[n]);
    if (!(distance > on_wall * nodes.edge[n])) continue;
    if (off == 0 && (nodes.is_held[n] != 0 || distance > far_off * nodes.edge[n])) {
      any_stays = true;
      continue;
    }
    off = distance;
    any_is_off = true;
  }
  found.any_stays = comm.any(any_stays);
  if (!comm.any(any_is_off)) found.off.clear();
  return found;
}

}  // namespace pamr::curved
