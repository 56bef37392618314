// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/peel.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::meshing {

namespace {

using geometry::Vec3;
using LocalEdge = std::pair<std::int32_t, std::int32_t>;
using LocalFace = std::array<std::int32_t, 3>;

LocalEdge edge_of(std::int32_t a, std::int32_t b) { return {std::min(a, b), std::max(a, b)}; }

LocalFace face_of(const RawMesh& mesh, std::int32_t cell, int slot) {
  LocalFace nodes{};
  for (std::size_t i = 0; i < 3; ++i) nodes[i] = mesh.cell[at(cell)][at(mesh::tet::face_to_corner[at(slot)][i])];
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

/// A cell with two boundary faces on one piece: the edge they share, and the one inside.
struct Ear {
  std::int32_t cell = 0;
  int piece = 0;
  LocalEdge outer, inner;
  std::array<int, 2> hidden{};  ///< slots of the two faces that are not on the boundary
};

std::vector<Ear> find_ears(const RawMesh& mesh) {
  std::map<std::int32_t, std::vector<BoundaryFace>> faces_of_cell;
  for (const auto& face : mesh.face) faces_of_cell[face.cell].push_back(face);
  std::vector<Ear> ears;
  for (const auto& [cell, faces] : faces_of_cell) {
    if (faces.size() != 2 || faces[0].piece != faces[1].piece) continue;
    // the corners opposite the two faces end the inner edge
    const int p = faces[0].slot, q = faces[1].slot;
    const int shared = mesh::tet::opposite_edge(mesh::tet::edge_of[at(p)][at(q)]);
    const auto [r, s] = mesh::tet::edge_to_corner[at(shared)];
    const auto& nodes = mesh.cell[at(cell)];
    ears.push_back(
        {cell, faces[0].piece, edge_of(nodes[at(r)], nodes[at(s)]), edge_of(nodes[at(p)], nodes[at(q)]), {r, s}});
  }
  return ears;
}

/// True when the wall at the middle of the inner edge lies still further into the gas than that edge does.
bool lies_behind(const Domain& domain, const RawMesh& mesh, const Ear& ear) {
  const auto middle = [&](LocalEdge e) { return geometry::midpoint(mesh.position(e.first), mesh.position(e.second)); };
  const Vec3 outer = middle(ear.outer), inner = middle(ear.inner);
  // far from the wall, as in the middle of a ball, the nearest point says nothing
  if (Domain::region_of(domain.label(inner)) >= 0) return false;
  return geometry::dot(domain.pieces[at(ear.piece)].nearest(inner) - inner, inner - outer) > 0;
}

std::map<LocalFace, BoundaryFace> faces_by_nodes(const RawMesh& mesh) {
  std::map<LocalFace, BoundaryFace> result;
  for (std::size_t c = 0; c < mesh.cell.size(); ++c)
    for (int slot = 0; slot < 4; ++slot) {
      const auto cell = static_cast<std::int32_t>(c);
      result.insert_or_assign(face_of(mesh, cell, slot), BoundaryFace{cell, slot, 0});
    }
  return result;
}

int peel_once(const Domain& domain, RawMesh& mesh) {
  std::set<LocalEdge> boundary_edges;
  for (const auto& face : mesh.face) {
    const auto n = face_of(mesh, face.cell, face.slot);
    boundary_edges.insert({edge_of(n[0], n[1]), edge_of(n[1], n[2]), edge_of(n[0], n[2])});
  }
  std::set<LocalFace> between;  // regions: the cell behind such a face is of another one, which ends there
  for (const auto& face : mesh.between) between.insert(face_of(mesh, face.cell, face.slot));
  const auto is_between = [&](const Ear& ear) {
    return std::any_of(ear.hidden.begin(), ear.hidden.end(),
                       [&](int slot) { return between.contains(face_of(mesh, ear.cell, slot)); });
  };
  std::vector<bool> gone(mesh.cell.size(), false);
  std::map<LocalFace, int> opened;  // faces behind the cells taken away, and their piece
  int n_gone = 0;
  for (const auto& ear : find_ears(mesh)) {
    if (boundary_edges.contains(ear.inner) || is_between(ear) || !lies_behind(domain, mesh, ear)) continue;
    boundary_edges.insert(ear.inner);
    gone[at(ear.cell)] = true;
    ++n_gone;
    for (const int slot : ear.hidden) opened[face_of(mesh, ear.cell, slot)] = ear.piece;
  }
  if (n_gone == 0) return 0;

  std::vector<std::int32_t> old_to_new(mesh.cell.size(), -1);
  RawMesh kept;
  kept.point = std::move(mesh.point);
  kept.binding = std::move(mesh.binding);
  for (std::size_t c = 0; c < mesh.cell.size(); ++c)
    if (!gone[c]) {
      old_to_new[c] = static_cast<std::int32_t>(kept.cell.size());
      kept.cell.push_back(mesh.cell[c]);
      if (!mesh.region.empty()) kept.region.push_back(mesh.region[c]);
    }
  kept.between = mesh.between;  // of cells that stay
  for (auto& face : kept.between) face.cell = old_to_new[at(face.cell)];
  for (auto face : mesh.face) {
    face.cell = old_to_new[at(face.cell)];
    if (face.cell >= 0) kept.face.push_back(face);
  }
  const auto by_nodes = faces_by_nodes(kept);
  for (const auto& [nodes, piece] : opened) {
    const auto behind = by_nodes.find(nodes);
    if (behind == by_nodes.end()) continue;  // between two cells that both went
    auto face = behind->second;
    face.piece = piece;
    kept.face.push_back(face);
  }
  mesh = std::move(kept);
  return n_gone;
}

}  // namespace

int peel(const Domain& domain, RawMesh& mesh) {
  int total = 0;
  for (int n = peel_once(domain, mesh); n > 0; n = peel_once(domain, mesh)) total += n;
  return total;
}

}  // namespace pamr::meshing
