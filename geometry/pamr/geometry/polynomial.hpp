// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "pamr/geometry/surface.hpp"

namespace pamr::geometry {

/// A piece of a parametric surface of second order: x(u, v) = c0 + c1 u + c2 v + c3 u^2 + c4 u v + c5 v^2 over a
/// rectangle of parameters.
struct PolynomialSegment {
  std::array<Vec3, 6> coefficient{};
  std::array<double, 2> u{0, 1}, v{0, 1};  ///< least and greatest parameter
};

/// A surface made of parametric segments of second order, as users of the PAMR method describe their bodies (the paper,
/// section 2.1.4). Segments should meet where the body is whole; each ends where its parameters do. The normal is that
/// of x_u x x_v at the nearest point, of the first among equally near segments. The seams are the segments' borders.
///
/// `project`: the nearest point over all segments, by Newton's method in (u, v), kept inside the rectangle and made to
/// descend, from every local minimum of a 5 x 5 grid; segments that lie farther than the best point so far are left
/// out. Cost: about a microsecond a segment that is near.
class Polynomial final : public Surface {
 public:
  /// Throws `Error` without segments, for numbers that are not finite, ranges that are empty and segments that are no
  /// surface anywhere on the grid.
  explicit Polynomial(std::vector<PolynomialSegment> segments);

  Vec3 project(Vec3 point) const override;
  Vec3 normal(Vec3 point) const override;
  Vec3 project_to_seam(Vec3 point) const override;
  double magnitude() const override;

 private:
  /// A ball that holds the segment.
  struct Ball {
    Vec3 center;
    double radius = 0;
  };
  struct Foot {
    std::size_t segment = 0;
    double u = 0, v = 0;
    Vec3 point;
    double squared_distance = 0;
  };
  Foot nearest(Vec3 point, bool on_borders) const;

  std::vector<PolynomialSegment> segment_;
  std::vector<Ball> ball_;
};

}  // namespace pamr::geometry
