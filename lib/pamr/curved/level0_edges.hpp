// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/curved/edge_nodes.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::curved {

constexpr double coarse_bulge = 1.0 / 40;  ///< of its edge: h / 8 R for h = 0.2 R

/// A mesh with what is known of its edges. Arrays by edge unless said otherwise.
struct Level0Edges {
  const par::Comm& comm;
  const mesh::DistMesh& mesh;
  const mesh::Borders& borders;
  EdgeNodes nodes;
  std::vector<LocalId> movable;  ///< of edges in curved walls; -1 elsewhere
  std::vector<geometry::Vec3> bulge;
  std::vector<std::uint8_t> is_coarse;

  LocalId edge(LocalId cell, std::size_t e) const {
    return nodes.numbering.edge_to_node[at(nodes.numbering.row[at(cell)])][e] - mesh.n_nodes();
  }
  std::size_t n_edges() const { return nodes.numbering.n_new_nodes(); }
  const std::array<LocalId, 2>& ends(std::size_t edge) const { return nodes.numbering.ends[edge]; }
};

/// Collective: as `place_edge_nodes`.
Level0Edges look_at_edges(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders);

/// Each coarse edge once over all ranks. Collective: one exchange.
std::vector<std::size_t> own_coarse_edges(const Level0Edges& edges);

}  // namespace pamr::curved
