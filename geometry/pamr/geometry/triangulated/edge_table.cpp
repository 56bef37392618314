// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/edge_table.hpp"

#include <algorithm>
#include <array>

#include "pamr/base/index.hpp"

namespace pamr::geometry {

EdgeTable::EdgeTable(const Triangulation& surface) {
  sides_.reserve(3 * surface.triangles.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = surface.triangles[t][at(k)], b = surface.triangles[t][at((k + 1) % 3)];
      sides_.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), k, a < b});
    }
  std::sort(sides_.begin(), sides_.end(), [](const Side& a, const Side& b) {
    return std::array{a.low, a.high, a.triangle, a.edge} < std::array{b.low, b.high, b.triangle, b.edge};
  });
}

}  // namespace pamr::geometry
