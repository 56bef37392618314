// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/triangulated/self_intersection.hpp"
#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::geometry {

/// Triangles that hang together over edges.
struct Shell {
  std::int64_t n_triangles = 0;
  double area = 0;
  double volume = 0;  ///< signed: negative where a closed shell is seen from inside
  bool is_closed = true;
  Vec3 where;  ///< a corner of its first triangle
  Box box;
  bool is_apart = true;  ///< none of its triangles touches or cuts one of another shell
  int depth = 0;         ///< in how many other closed shells it lies; of closed shells that are apart
};

/// Two shells that touch or cut each other.
struct Contact {
  int first = 0, second = 0;  ///< shells
  Vec3 where;
};

struct Shells {
  std::vector<int> of_triangle;
  std::vector<Shell> shell;      ///< in the order of their first triangles
  std::vector<Contact> contact;  ///< one for each pair of shells
};

/// The shells of any triangles without a point twice: `is_apart` and `depth` are not looked for. Local. O(n log n).
Shells find_shells(const Triangulation& surface);

/// Finds out how the shells of a manifold lie to one another, exactly: which touch or cut others, and in how many
/// others those lie that do not. A shell beside the others in a point, an edge or a face touches. Returns the pairs of
/// triangles that touch or cut each other, of one shell too, and gives each to `use`. Local. Cost: of
/// `find_self_intersections`, and for each shell as many operations as the shells around its place have triangles.
SelfIntersections nest_shells(const Triangulation& surface, Shells& shells,
                              const std::function<void(const Cut&)>& use = {});

/// Closed shells that are apart and seen from the wrong side, ascending: those around which no shell or an even number
/// lies face outwards, the others inwards, since they are cavities. `outside_in`: the other way around for all.
std::vector<int> turned_shells(const Shells& shells, Exact<bool> outside_in = false);

/// Whether a surface has an inside.
struct Inside {
  /// Why it has none within bounds: one sentence with the name of the surface and the first place.
  std::optional<std::string> fault;
  SelfIntersections self_intersections;  ///< wherever they are
};

/// A surface, part of which lies in `bounds`, has no inside there where shells touch or cut each other, where triangles
/// cut others, and where shells face neither outwards and inwards in turn nor inwards and outwards. Pre:
/// `require_valid`. Local. Cost: of `nest_shells`.
Inside find_inside(const Triangulation& surface, const Box& bounds);

}  // namespace pamr::geometry
