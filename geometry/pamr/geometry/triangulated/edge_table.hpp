// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::geometry {

/// One side of one triangle, from its corner `edge` to the next.
struct Side {
  int low = 0, high = 0;  ///< numbers of its points
  int triangle = 0, edge = 0;
  bool upwards = false;  ///< runs from `low` to `high`
};

/// All edges of triangles that need not be a surface: any number of triangles may meet at one. Edges in the order of
/// their points, the sides of an edge in the order of their triangles. Triangles with a point twice must not be there.
/// Local; O(n log n), 20 bytes a side.
class EdgeTable {
 public:
  explicit EdgeTable(const Triangulation& surface);

  /// Calls `use(sides)` with the sides of each edge.
  template <class Use>
  void for_each_edge(Use&& use) const {
    for (std::size_t i = 0; i < sides_.size();) {
      auto end = i + 1;
      while (end < sides_.size() && sides_[end].low == sides_[i].low && sides_[end].high == sides_[i].high) ++end;
      use(std::span<const Side>(sides_).subspan(i, end - i));
      i = end;
    }
  }

 private:
  std::vector<Side> sides_;
};

}  // namespace pamr::geometry
