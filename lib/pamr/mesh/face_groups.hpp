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
/// and 8 a node. Local; O(cells).
class FaceGroups {
 public:
  explicit FaceGroups(const DistMesh& mesh);

  /// Calls `visit(span<const CellFace>)` for each set of faces with the same three nodes, ascending in cell and slot;
  /// sets in order of their smallest nodes (local numbers), and at one node of their first faces.
  template <class Visit>
  void for_each(Visit&& visit) const;

 private:
  /// Faces with the same nodes; of more than two the first two.
  struct Group {
    std::uint64_t others = 0;  // the middle and the largest of its nodes
    std::uint32_t n = 0;
    std::array<std::uint32_t, 2> from{};
  };
  /// The groups at one smallest node.
  struct AtNode {
    std::vector<Group> group;
    std::vector<std::array<std::uint32_t, 2>> more;  // groups and their third and further faces, ascending
    std::vector<std::uint32_t> table;                // by hash: a number of a group, counted from 1, or 0
  };
  void collect(std::size_t node, AtNode& found) const;
  static CellFace face_of(std::uint32_t from) { return {static_cast<LocalId>(from / 4), static_cast<int>(from % 4)}; }

  const DistMesh* mesh_;
  std::vector<std::size_t> offset_;  // faces of node n: from_[offset_[n] .. offset_[n+1])
  std::vector<std::uint32_t> from_;  // 4 * cell + slot
};

template <class Visit>
void FaceGroups::for_each(Visit&& visit) const {
  AtNode found;
  std::vector<CellFace> many;
  for (std::size_t node = 0; node + 1 < offset_.size(); ++node) {
    collect(node, found);
    auto more = found.more.begin();
    for (std::uint32_t g = 0; g < found.group.size(); ++g) {
      const auto& group = found.group[g];
      const std::array<CellFace, 2> pair{face_of(group.from[0]), face_of(group.from[1])};
      if (group.n <= pair.size()) {
        visit(std::span(pair).first(group.n));
        continue;
      }
      many.assign(pair.begin(), pair.end());
      for (; more != found.more.end() && (*more)[0] == g; ++more) many.push_back(face_of((*more)[1]));
      visit(std::span<const CellFace>(many));
    }
  }
}

}  // namespace pamr::mesh
