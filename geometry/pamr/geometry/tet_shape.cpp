// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/tet_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace pamr::geometry {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Edges {
  Vec3 u, v, w;          // from corner 0 to corners 1, 2, 3
  double uu, vv, ww;     // their squared lengths
  double vu2, wv2, uw2;  // squared lengths of the opposite edges 1-2, 2-3, 3-1
  double longest() const { return std::sqrt(std::max({uu, vv, ww, vu2, wv2, uw2})); }
  double shortest() const { return std::sqrt(std::min({uu, vv, ww, vu2, wv2, uw2})); }
};

Edges edges_of(const TetPoints& p) {
  const Vec3 u = p[1] - p[0], v = p[2] - p[0], w = p[3] - p[0];
  return {u,
          v,
          w,
          squared_norm(u),
          squared_norm(v),
          squared_norm(w),
          squared_norm(p[2] - p[1]),
          squared_norm(p[3] - p[2]),
          squared_norm(p[1] - p[3])};
}

/// Outward area vectors of the faces opposite the corners, times two (for a positive cell), and six times the volume.
struct Faces {
  std::array<Vec3, 4> normal;
  double determinant;
  double inner_radius() const {
    const double area = norm(normal[0]) + norm(normal[1]) + norm(normal[2]) + norm(normal[3]);
    return area > 0 ? std::abs(determinant) / area : 0;
  }
};

Faces faces_of(const TetPoints& p, const Edges& e) {
  const Vec3 uv = cross(e.u, e.v);
  return {{cross(p[2] - p[1], p[3] - p[1]), cross(e.w, e.v), cross(e.u, e.w), -uv}, dot(uv, e.w)};
}

}  // namespace

double mean_ratio(const TetPoints& p) {
  const Edges e = edges_of(p);
  const double sum = e.uu + e.vv + e.ww + e.vu2 + e.wv2 + e.uw2;
  if (!(sum > 0)) return 0;
  const double determinant = dot(cross(e.u, e.v), e.w);
  const double side = std::cbrt(0.5 * std::abs(determinant));  // (3V)^(1/3): squared after the root, V^2 may underflow
  return std::copysign(12.0 * side * side / sum, determinant);
}

double radius_ratio(const TetPoints& p) {
  const Edges e = edges_of(p);
  const Faces f = faces_of(p, e);
  const double size = std::abs(f.determinant);
  // Circumradius = |w^2 u x v + v^2 w x u + u^2 v x w| / (2 determinant).
  const double around = norm(-e.ww * f.normal[3] - e.vv * f.normal[2] - e.uu * f.normal[1]);
  return around > 0 ? 3.0 * f.inner_radius() * (2.0 * size / around) : 0;
}

double aspect_ratio(const TetPoints& p) {
  const Edges e = edges_of(p);
  const double radius = faces_of(p, e).inner_radius();
  return radius > 0 ? e.longest() / (2.0 * std::sqrt(6.0) * radius) : infinity;
}

double edge_ratio(const TetPoints& p) {
  const Edges e = edges_of(p);
  const double shortest = e.shortest();
  return shortest > 0 ? e.longest() / shortest : infinity;
}

DihedralAngles dihedral_angles(const TetPoints& p) {
  const Edges e = edges_of(p);
  const Faces f = faces_of(p, e);
  // At an edge of length l between faces i and j: cotangent = -(n_i . n_j) / (l |determinant|). The determinant is the
  // same for all six, so the extremes of -(n_i . n_j) / l give the extreme angles and two arc tangents do.
  const std::array<double, 6> length2 = {e.uu, e.vv, e.ww, e.vu2, e.wv2, e.uw2};
  constexpr std::array<std::array<std::size_t, 2>, 6> sides = {{{2, 3}, {1, 3}, {1, 2}, {0, 3}, {0, 1}, {0, 2}}};
  double least = infinity, greatest = -infinity;
  for (std::size_t k = 0; k < 6; ++k) {
    const double product = -dot(f.normal[sides[k][0]], f.normal[sides[k][1]]);
    const double cotangent = length2[k] > 0 ? product / std::sqrt(length2[k]) : 0;
    least = std::min(least, cotangent);
    greatest = std::max(greatest, cotangent);
  }
  const double size = std::abs(f.determinant);
  constexpr double degrees = 180.0 / std::numbers::pi;
  return {degrees * std::atan2(size, greatest), degrees * std::atan2(size, least)};
}

}  // namespace pamr::geometry
