// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "pamr/geometry/box.hpp"
#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// Parameters of the nearest point of a triangle with sides ab and ac, seen from a; `ap` leads to the point.
/// Source: C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
std::array<double, 2> nearest_parameters(Vec3 ab, Vec3 ac, Vec3 ap);

/// A tree of boxes about flat triangles that answers which one is nearest. Local, thread-safe; the answer depends on
/// the triangles and their order only. 150 bytes a triangle; a query takes O(log n) near the surface.
class TriangleTree {
 public:
  /// Triangles may be segments (two corners equal).
  explicit TriangleTree(std::span<const std::array<Vec3, 3>> triangles);

  struct Hit {
    int triangle = -1;
    double u = 0, v = 0;  ///< nearest point = (1 - u - v) a + u b + v c
  };
  /// Triangle -1 where none is within `distance_limit`.
  Hit nearest(Vec3 point, double distance_limit = std::numeric_limits<double>::infinity()) const;

 private:
  struct Node {
    std::array<Box, 2> box;      ///< of the two children
    std::array<int, 2> child{};  ///< number of a node, or -1 - first triangle of a leaf
    std::array<int, 2> count{};  ///< triangles of a leaf
  };
  struct Entry {
    Vec3 a, ab, ac;
    int triangle = 0;
  };
  struct Item {
    std::array<Vec3, 3> corner;
    Vec3 center;
    int triangle = 0;
  };
  int build(std::span<Item> items, std::size_t first);
  static Box box_of_items(std::span<const Item> items);

  std::vector<Node> nodes_;
  std::vector<Entry> entries_;
};

}  // namespace pamr::geometry
