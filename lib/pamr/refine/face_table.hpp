// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "pamr/base/hash.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::refine {

/// Open-addressing table of cell faces by their three nodes, for the few faces that no constant table links: those
/// between two families that were both taken back.
class FaceTable {
 public:
  FaceTable(const std::vector<mesh::CellNodes>& cell_to_node, std::size_t n_faces)
      : cell_to_node_(cell_to_node), entry_(std::bit_ceil(2 * n_faces + 1)) {}

  /// The face put in earlier with the same nodes, or, when there is none, `face` itself, which is now in the table.
  mesh::CellFace find_or_insert(mesh::CellFace face) {
    auto& entry = locate(nodes_of(face));
    if (entry.cell == invalid_local) entry = face;
    return entry;
  }

  std::array<LocalId, 3> nodes_of(mesh::CellFace face) const {
    const auto& nodes = cell_to_node_[static_cast<std::size_t>(face.cell)];
    const auto& corner = mesh::tet::face_to_corner[static_cast<std::size_t>(face.slot)];
    std::array<LocalId, 3> key{nodes[static_cast<std::size_t>(corner[0])], nodes[static_cast<std::size_t>(corner[1])],
                               nodes[static_cast<std::size_t>(corner[2])]};
    std::sort(key.begin(), key.end());
    return key;
  }

 private:
  mesh::CellFace& locate(const std::array<LocalId, 3>& key) {
    std::uint64_t h = 0;
    for (const auto node : key) h = combine(h, static_cast<std::uint64_t>(node));
    for (auto i = static_cast<std::size_t>(h) & (entry_.size() - 1);; i = (i + 1) & (entry_.size() - 1))
      if (entry_[i].cell == invalid_local || nodes_of(entry_[i]) == key) return entry_[i];
  }

  const std::vector<mesh::CellNodes>& cell_to_node_;
  std::vector<mesh::CellFace> entry_;
};

}  // namespace pamr::refine
