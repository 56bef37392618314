// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/validate/validate_faces.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "pamr/base/memory.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::validate {

namespace {

std::array<LocalId, 3> face_nodes(const mesh::CellNodes& nodes, std::size_t f) {
  const auto& corner = mesh::tet::face_to_corner[f];
  return {nodes[static_cast<std::size_t>(corner[0])], nodes[static_cast<std::size_t>(corner[1])],
          nodes[static_cast<std::size_t>(corner[2])]};
}

/// True when cell `d` names `c` across face `f` of `c`, turning around it the other way.
bool is_met(const mesh::DistMesh& mesh, LocalId c, std::size_t f, LocalId d) {
  const auto a = face_nodes(mesh.cell_to_node[static_cast<std::size_t>(c)], f);
  for (std::size_t g = 0; g < 4; ++g) {
    if (mesh.cell_to_cell[static_cast<std::size_t>(d)][g] != c) continue;
    const auto b = face_nodes(mesh.cell_to_node[static_cast<std::size_t>(d)], g);
    if ((b[0] == a[0] && b[1] == a[2] && b[2] == a[1]) || (b[0] == a[2] && b[1] == a[1] && b[2] == a[0]) ||
        (b[0] == a[1] && b[1] == a[0] && b[2] == a[2]))
      return true;
  }
  return false;
}

/// True when patches exist and own neighbors are returned. Links up (to a cell with a larger number) meet as many
/// different links down; when there are no more of these, they are all met.
bool links_match(const mesh::DistMesh& mesh) {
  const auto n_patches = static_cast<int>(mesh.info.patches.size());
  std::int64_t n_up = 0, n_down = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto slot = mesh.cell_to_cell[static_cast<std::size_t>(c)][f];
      if (slot < 0) {
        if (slot == invalid_local || mesh::slot_to_patch(slot) >= n_patches) return false;
      } else if (slot < c) {
        ++n_down;
      } else if (slot < mesh.n_cells()) {
        if (!is_met(mesh, c, f, slot)) return false;
        ++n_up;
      }
    }
  return n_up == n_down;
}

/// Calls `visit(smallest node, the two others in one word)` for every face that is not seen from a cell further on.
template <class Visit>
void for_each_face(const mesh::DistMesh& mesh, Visit&& visit) {
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto slot = mesh.cell_to_cell[static_cast<std::size_t>(c)][f];
      if (slot >= 0 && slot < c) continue;
      auto [a, b, d] = face_nodes(mesh.cell_to_node[static_cast<std::size_t>(c)], f);
      if (b < a) std::swap(a, b);
      if (d < a) std::swap(a, d);
      if (d < b) std::swap(b, d);
      visit(static_cast<std::size_t>(a), static_cast<std::uint64_t>(b) << 32U | static_cast<std::uint64_t>(d));
    }
}

bool has_equal_words(std::span<std::uint64_t> words) {
  if (words.size() > 64) {
    std::sort(words.begin(), words.end());
    return std::adjacent_find(words.begin(), words.end()) != words.end();
  }
  bool equal = false;
  for (std::size_t i = 1; i < words.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) equal |= words[k] == words[i];
  return equal;
}

/// True when no two of the faces, each pair of linked ones taken once, have the same nodes.
bool faces_differ(const mesh::DistMesh& mesh) {
  std::vector<std::size_t> end(mesh.node_position.size() + 1, 0);
  for_each_face(mesh, [&](std::size_t node, std::uint64_t) { ++end[node + 1]; });
  for (std::size_t node = 1; node < end.size(); ++node) end[node] += end[node - 1];
  std::vector<std::uint64_t> words;
  assign_array(words, end.back(), std::uint64_t{0});
  for_each_face(mesh, [&](std::size_t node, std::uint64_t word) { words[end[node]++] = word; });
  std::size_t begin = 0;  // `end[node]` has come to where the words of the node end
  for (std::size_t node = 0; node + 1 < end.size(); begin = end[node++])
    if (has_equal_words(std::span(words).subspan(begin, end[node] - begin))) return false;
  return true;
}

}  // namespace

bool own_faces_match(const mesh::DistMesh& mesh) { return links_match(mesh) && faces_differ(mesh); }

}  // namespace pamr::validate
