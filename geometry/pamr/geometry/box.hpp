// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <limits>

#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// A box along the axes, closed; empty while `low` is above `high`, as it is from the start.
struct Box {
  Vec3 low = infinite, high = -infinite;

  /// Makes the box hold a point. A coordinate that is NaN changes nothing.
  constexpr void extend(Vec3 p) { merge({p, p}); }
  /// Makes the box hold another one.
  constexpr void merge(const Box& other) {
    low = {std::min(low.x, other.low.x), std::min(low.y, other.low.y), std::min(low.z, other.low.z)};
    high = {std::max(high.x, other.high.x), std::max(high.y, other.high.y), std::max(high.z, other.high.z)};
  }

  constexpr bool is_empty() const { return low.x > high.x || low.y > high.y || low.z > high.z; }
  constexpr bool contains(Vec3 p) const {
    return low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y && low.z <= p.z && p.z <= high.z;
  }
  constexpr Vec3 size() const { return high - low; }
  constexpr Vec3 center() const { return midpoint(low, high); }
  double diagonal() const { return norm(high - low); }
  /// Squared distance of a point from the box; 0 inside.
  constexpr double squared_distance(Vec3 p) const {
    const double x = std::max({low.x - p.x, 0.0, p.x - high.x});
    const double y = std::max({low.y - p.y, 0.0, p.y - high.y});
    const double z = std::max({low.z - p.z, 0.0, p.z - high.z});
    return x * x + y * y + z * z;
  }

 private:
  static constexpr Vec3 infinite{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
                                 std::numeric_limits<double>::infinity()};
};

/// The smallest box that holds the points. Local.
template <class Points>
constexpr Box box_of(const Points& points) {
  Box box;
  for (const Vec3 p : points) box.extend(p);
  return box;
}

}  // namespace pamr::geometry
