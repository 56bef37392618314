// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/rank_border.hpp"

#include <algorithm>

#include "pamr/mesh/face_groups.hpp"

namespace pamr::mesh {

namespace {

/// The faces by rank, those of one rank by the cell on the lower of the two ranks, then by the other one: both sides
/// have the same order without knowing more than the cells.
std::vector<RemoteFace> in_order(const DistMesh& mesh, Rank here, const std::vector<RemoteFace>& faces) {
  Rank n_ranks = 0;
  for (const auto& face : faces) n_ranks = std::max(n_ranks, face.rank + 1);
  std::vector<std::size_t> end(static_cast<std::size_t>(n_ranks) + 1, 0);
  for (const auto& face : faces) ++end[static_cast<std::size_t>(face.rank) + 1];
  for (std::size_t r = 1; r < end.size(); ++r) end[r] += end[r - 1];
  std::vector<RemoteFace> sorted(faces.size());
  for (const auto& face : faces) sorted[end[static_cast<std::size_t>(face.rank)]++] = face;
  const auto comes_first = [&](const RemoteFace& a, const RemoteFace& b) {
    const auto own_a = a.face.cell, own_b = b.face.cell;
    if (own_a == own_b && a.other == b.other) return face_key(mesh, a.face) < face_key(mesh, b.face);
    if (here < a.rank) return own_a != own_b ? own_a < own_b : a.other < b.other;
    return a.other != b.other ? a.other < b.other : own_a < own_b;
  };
  for (std::size_t r = 0, begin = 0; r + 1 < end.size(); begin = end[r++])
    if (end[r] - begin > 1)
      std::sort(sorted.begin() + static_cast<std::ptrdiff_t>(begin),
                sorted.begin() + static_cast<std::ptrdiff_t>(end[r]), comes_first);
  return sorted;
}

}  // namespace

void fill_border(Rank here, DistMesh& mesh, const std::vector<RemoteFace>& remote) {
  const auto faces = in_order(mesh, here, remote);
  mesh.border_face.reserve(faces.size());
  mesh.ghost_global.reserve(faces.size());
  for (const auto& face : faces) {
    if (mesh.border_rank.empty() || mesh.border_rank.back() != face.rank) {
      mesh.border_rank.push_back(face.rank);
      mesh.border_offset.push_back(mesh.border_face.size());
    }
    mesh.cell_to_cell[static_cast<std::size_t>(face.face.cell)][static_cast<std::size_t>(face.face.slot)] =
        mesh.n_cells() + static_cast<LocalId>(mesh.border_face.size());
    mesh.border_face.push_back(face.face);
    mesh.ghost_global.push_back(face.other);
    mesh.border_offset.back() = mesh.border_face.size();
  }
}

}  // namespace pamr::mesh
