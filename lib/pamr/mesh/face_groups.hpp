// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pamr/base/hash.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::mesh {

/// Global numbers of a face's nodes, ascending: its name on every rank. `nodes`: of the cell, by local id; `slot`: the
/// corner opposite the face.
inline par::SharedKey face_key(const CellNodes& nodes, int slot, const std::vector<GlobalId>& node_global) {
  par::SharedKey key{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto corner = tet::face_to_corner[static_cast<std::size_t>(slot)][i];
    key[i] = node_global[static_cast<std::size_t>(nodes[static_cast<std::size_t>(corner)])];
  }
  const auto least = std::min({key[0], key[1], key[2]}), most = std::max({key[0], key[1], key[2]});
  return {least, key[0] ^ key[1] ^ key[2] ^ least ^ most, most};
}

inline par::SharedKey face_key(const DistMesh& mesh, CellFace face) {
  return face_key(mesh.cell_to_node[static_cast<std::size_t>(face.cell)], face.slot, mesh.node_global);
}

/// A hash of a face's nodes, whatever their order: the same on every rank.
inline std::uint64_t face_name(const CellNodes& nodes, int slot, const std::vector<GlobalId>& node_global) {
  std::uint64_t sum = 0;
  for (const auto corner : tet::face_to_corner[static_cast<std::size_t>(slot)])
    sum +=
        mix(static_cast<std::uint64_t>(node_global[static_cast<std::size_t>(nodes[static_cast<std::size_t>(corner)])]));
  return sum;
}
inline std::uint64_t face_name(const DistMesh& mesh, CellFace face) {
  return face_name(mesh.cell_to_node[static_cast<std::size_t>(face.cell)], face.slot, mesh.node_global);
}

/// A hash of what both sides of rank-border face `k` know of it: its nodes, the cell on the lower of the two ranks and
/// the one on the higher. Equal on both sides when they name each other's cell across the same nodes.
inline std::uint64_t border_word(const DistMesh& mesh, std::size_t k, bool is_lower_rank) {
  const auto face = mesh.border_face[k];
  const auto own = static_cast<std::uint64_t>(mesh.cell_global[static_cast<std::size_t>(face.cell)]);
  const auto other = static_cast<std::uint64_t>(mesh.ghost_global[k]);
  return combine(combine(face_name(mesh, face), is_lower_rank ? own : other), is_lower_rank ? other : own);
}

/// The faces of this rank's cells grouped by their nodes, found through the faces at each smallest node: 4 bytes a face
/// and 8 a node. Local; O(cells log(faces at a node)).
class FaceGroups {
 public:
  explicit FaceGroups(const DistMesh& mesh);

  /// Calls `visit(span<const CellFace>)` for each set of faces with the same three nodes, ascending in cell and slot;
  /// sets in order of their local nodes.
  template <class Visit>
  void for_each(Visit&& visit) const;

 private:
  struct FaceAtNode {
    std::uint64_t others = 0;  // the middle and the largest of its nodes, which have the smallest in common
    std::uint32_t from = 0;
  };
  void collect(std::size_t node, std::vector<FaceAtNode>& faces) const;

  const DistMesh* mesh_;
  std::vector<std::size_t> offset_;  // faces of node n: from_[offset_[n] .. offset_[n+1])
  std::vector<std::uint32_t> from_;  // 4 * cell + slot
};

template <class Visit>
void FaceGroups::for_each(Visit&& visit) const {
  std::vector<FaceAtNode> faces;
  std::vector<CellFace> group;
  for (std::size_t node = 0; node + 1 < offset_.size(); ++node) {
    collect(node, faces);
    for (std::size_t begin = 0, end = 0; begin < faces.size(); begin = end) {
      group.clear();
      for (; end < faces.size() && faces[end].others == faces[begin].others; ++end)
        group.push_back({static_cast<LocalId>(faces[end].from / 4), static_cast<int>(faces[end].from % 4)});
      visit(std::span<const CellFace>(group));
    }
  }
}

}  // namespace pamr::mesh
