// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/peel.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "meshing/ears.hpp"
#include "pamr/base/index.hpp"

namespace pamr::meshing {

namespace {

using geometry::Vec3;

/// True when the wall at the middle of the inner edge lies still further into the gas than that edge does.
bool lies_behind(const Domain& domain, const RawMesh& mesh, const Ear& ear) {
  const Vec3 outer = middle_of(mesh, ear.outer), inner = middle_of(mesh, ear.inner);
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
  for (const auto& face : mesh.face)
    for (const auto& edge : edges_of(face_of(mesh, face.cell, face.slot))) boundary_edges.insert(edge);
  std::set<LocalFace> between;  // regions: the cell behind such a face is of another one, which ends there
  for (const auto& face : mesh.between) between.insert(face_of(mesh, face.cell, face.slot));
  const auto is_between = [&](const Ear& ear) {
    return std::any_of(ear.hidden.begin(), ear.hidden.end(),
                       [&](int slot) { return between.contains(face_of(mesh, ear.cell, slot)); });
  };
  std::vector<bool> gone(mesh.cell.size(), false);
  std::map<LocalFace, int> opened;  // faces behind the cells taken away, and their piece
  int n_gone = 0;
  for (const auto& ear : find_ears(mesh, mesh.face)) {
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
