// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/crossing.hpp"

#include <cstddef>

namespace pamr::meshing {

using geometry::Vec3;

Crossing find_crossing(const std::array<Vec3, 2>& end, const std::array<int, 2>& region, double squared_error,
                       const std::function<Domain::Ball(Vec3)>& around, const std::function<void(Vec3)>& count) {
  std::array<Domain::Ball, 2> known;  // the last on each side
  Crossing result{geometry::midpoint(end[0], end[1]), end, region};
  for (count(result.point); !(squared_norm(result.end[1] - result.end[0]) < squared_error); count(result.point)) {
    const Vec3 p = result.point;
    const auto* ball = known[0].holds(p) ? &known[0] : known[1].holds(p) ? &known[1] : nullptr;
    const auto found = ball != nullptr ? *ball : around(p);
    const std::size_t side = found.region == result.region[0] ? 0 : 1;
    known[side] = found;
    result.end[side] = p;
    result.region[side] = found.region;
    result.point = geometry::midpoint(result.end[0], result.end[1]);
  }
  return result;
}

}  // namespace pamr::meshing
