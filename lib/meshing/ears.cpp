// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/ears.hpp"

#include <algorithm>
#include <map>

#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::meshing {

LocalEdge edge_between(std::int32_t a, std::int32_t b) { return {std::min(a, b), std::max(a, b)}; }

LocalFace face_of(const RawMesh& mesh, std::int32_t cell, int slot) {
  LocalFace nodes{};
  for (std::size_t i = 0; i < 3; ++i) nodes[i] = mesh.cell[at(cell)][at(mesh::tet::face_to_corner[at(slot)][i])];
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

std::array<LocalEdge, 3> edges_of(const LocalFace& face) {
  return {{{face[0], face[1]}, {face[1], face[2]}, {face[0], face[2]}}};
}

geometry::Vec3 middle_of(const RawMesh& mesh, LocalEdge edge) {
  return geometry::midpoint(mesh.position(edge.first), mesh.position(edge.second));
}

std::vector<Ear> find_ears(const RawMesh& mesh, std::span<const BoundaryFace> faces) {
  std::map<std::int32_t, std::vector<BoundaryFace>> faces_of_cell;
  for (const auto& face : faces) faces_of_cell[face.cell].push_back(face);
  std::vector<Ear> ears;
  for (const auto& [cell, of_cell] : faces_of_cell) {
    if (of_cell.size() != 2 || of_cell[0].piece != of_cell[1].piece) continue;
    // the corners opposite the two faces end the inner edge
    const int p = of_cell[0].slot, q = of_cell[1].slot;
    const int shared = mesh::tet::opposite_edge(mesh::tet::edge_of[at(p)][at(q)]);
    const auto [r, s] = mesh::tet::edge_to_corner[at(shared)];
    const auto& nodes = mesh.cell[at(cell)];
    ears.push_back({cell,
                    of_cell[0].piece,
                    edge_between(nodes[at(r)], nodes[at(s)]),
                    edge_between(nodes[at(p)], nodes[at(q)]),
                    {p, q},
                    {r, s}});
  }
  return ears;
}

}  // namespace pamr::meshing
