// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// The nearest point of a piece with its parameters.
struct Foot {
  Vec3 point;
  double squared_distance = 0;
  double u = 0, v = 0;
};

/// A cubic curve over [0, 1], given by its four Bezier points.
class CurvedEdge {
 public:
  explicit CurvedEdge(const std::array<Vec3, 4>& control);
  Vec3 point(double u) const;
  /// Nearest point by safeguarded Newton steps from parameter u.
  Foot nearest(Vec3 to, double u) const;

 private:
  std::array<Vec3, 4> coefficient_;
};

/// A cubic triangle over u, v >= 0, u + v <= 1, with corner a at (0, 0), b at (1, 0) and c at (0, 1). Neighbors share
/// their edge curve, so the surface of many is continuous.
/// Source: A. Vlachos, J. Peters, C. Boyd, J. Mitchell, Curved PN triangles, 2001; here the inner points of the edges
/// are given, at the distance that makes arcs of circles good to sixth order.
class CurvedTriangle {
 public:
  /// `edge`: for each edge from corner k to corner k + 1 its two inner Bezier points in that order.
  CurvedTriangle(const std::array<Vec3, 3>& corner, const std::array<std::array<Vec3, 2>, 3>& edge);

  Vec3 point(double u, double v) const;
  /// Along S_u x S_v, not of unit length.
  Vec3 normal(double u, double v) const;
  /// Nearest point by Newton steps, each to the minimum of the quadratic model over the whole triangle, from (u, v);
  /// never farther than the start.
  Foot nearest(Vec3 to, double u, double v) const;
  bool is_flat() const { return is_flat_; }

 private:
  std::array<Vec3, 10> coefficient_;  // of 1, u, v, u^2, u v, v^2, u^3, u^2 v, u v^2, v^3
  bool is_flat_ = false;
};

/// Inner Bezier point of a curve at its end `from` that leaves along the unit vector `tangent` to `to`, exact to sixth
/// order for an arc.
Vec3 inner_point(Vec3 from, Vec3 to, Vec3 tangent);

/// Inner Bezier points of the curve between two points of a smooth piece with these unit normals there.
std::array<Vec3, 2> smooth_edge(Vec3 a, Vec3 b, Vec3 normal_a, Vec3 normal_b);

}  // namespace pamr::geometry
