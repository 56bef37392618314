// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::geometry {

/// Where a triangulation cuts through itself: pairs of triangles that have a point in common other than a common
/// corner or edge, folded pairs included.
struct SelfIntersections {
  std::int64_t n_pairs = 0;
  bool has_more = false;  ///< the search ended at `most` pairs
  Vec3 where;             ///< a corner of the first triangle of the first pair
};

/// Counts them, exactly, with a tree of boxes. The triangulation must be valid (`require_valid`). Local. About half a
/// second for 100,000 triangles that do not cut each other.
SelfIntersections find_self_intersections(const Triangulation& surface, Exact<std::int64_t> most = 1000000);

/// Two triangles that touch or cut each other otherwise than in a common corner or edge.
struct Cut {
  int first = 0, second = 0;  ///< triangles
  Vec3 where;                 ///< the middle of what their boxes have in common
};
/// Calls `use` for each of them, in no certain order. Pre: a manifold. Local.
void for_each_cut(const Triangulation& surface, const std::function<void(const Cut&)>& use);

/// One line that names the surface, says how many pairs there are and where the first one is; empty for none.
std::string self_intersection_warning(const Triangulation& surface);

}  // namespace pamr::geometry
