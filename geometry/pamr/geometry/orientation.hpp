// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// Exact sign (-1, 0, 1) of (b-a) x (c-a) . (d-a) by CGAL's exact predicate: the slow path of `orientation`, about
/// 300 ns for a flat cell. Pre: all coordinates are finite.
int exact_orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d);

/// Exact sign (-1, 0, 1) of the volume (b-a) x (c-a) . (d-a) of a tetrahedron whose corners are the given doubles.
/// A floating-point filter decides nearly all calls; the rest go to CGAL's exact predicate. Pre: finite coordinates.
/// Source of the filter: J. R. Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric
/// predicates, 1997, bound A of orient3d; the last term covers products that underflow. An overflow makes the bound
/// infinite, hence the exact path.
inline int orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const double xy = u.x * v.y, yx = u.y * v.x;
  const double yz = u.y * v.z, zy = u.z * v.y;
  const double zx = u.z * v.x, xz = u.x * v.z;
  const double determinant = (yz - zy) * w.x + (zx - xz) * w.y + (xy - yx) * w.z;
  const double wx = std::abs(w.x), wy = std::abs(w.y), wz = std::abs(w.z);
  const double permanent =
      (std::abs(yz) + std::abs(zy)) * wx + (std::abs(zx) + std::abs(xz)) * wy + (std::abs(xy) + std::abs(yx)) * wz;
  constexpr double relative = 0x1p-50;  // 8 units of rounding; Shewchuk's 7 + 56 eps, rounded up
  const double bound = relative * permanent + 1e-300 * (wx + wy + wz + 1.0);
  if (determinant > bound) return 1;
  if (determinant < -bound) return -1;
  return exact_orientation(a, b, c, d);
}

/// True when the tetrahedron has positive volume by exact arithmetic.
inline bool is_positive(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return orientation(a, b, c, d) > 0; }

}  // namespace pamr::geometry
