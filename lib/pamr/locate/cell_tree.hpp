// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pamr/geometry/box.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::locate {

/// Boxes over the cells of this rank in the order of Hilbert's curve: over 8 cells each, over 8 of these boxes each,
/// and so on up to one over all. 11 bytes a cell. The mesh must outlive it and stay as it is.
class CellTree {
 public:
  /// Local. Cost: O(cells).
  explicit CellTree(const mesh::DistMesh& mesh);

  /// The box of all cells.
  geometry::Box box() const;

  /// The cells whose boxes hold a point, in any order. Cost: O(log(cells)) where cells are of similar shape.
  template <class Visit>
  void for_each_near(geometry::Vec3 point, Visit&& visit) const {
    if (!levels_.empty()) descend(levels_.size() - 1, 0, point, visit);
  }

 private:
  static constexpr std::size_t width = 8;

  template <class Visit>
  void descend(std::size_t level, std::size_t node, geometry::Vec3 point, Visit& visit) const {
    if (!levels_[level][node].contains(point)) return;
    const auto begin = node * width;
    const auto n = level == 0 ? order_.size() : levels_[level - 1].size();
    for (auto i = begin; i < begin + width && i < n; ++i)
      if (level == 0)
        visit(static_cast<LocalId>(order_[i]));
      else
        descend(level - 1, i, point, visit);
  }

  std::vector<std::uint32_t> order_;                ///< cells along the curve
  std::vector<std::vector<geometry::Box>> levels_;  ///< from the boxes of cells to the one box of all
};

}  // namespace pamr::locate
