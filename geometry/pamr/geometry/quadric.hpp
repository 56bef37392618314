// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "pamr/geometry/surface.hpp"

namespace pamr::geometry {

/// The points where a polynomial of second order in x, y, z is zero: ellipsoids, elliptic and hyperbolic paraboloids,
/// hyperboloids, cylinders and cones over conics, pairs of planes. The normal points to where the polynomial is
/// positive. Points with several nearest points (on axes, centers) get one of them, always the same.
///
/// `project` gives the nearest point of the whole surface, not a near one: with the Lagrange multiplier t of the
/// constraint, the polynomial along the critical points falls monotonically in t wherever 1 + t A is positive definite
/// (A: matrix of the squares), and the multiplier of the global minimum lies there. Source: J. J. More,
/// "Generalizations of the trust region problem", Optim. Methods Softw. 2 (1993). Cost: 5 to 15 evaluations of a
/// rational function.
class Quadric final : public Surface {
 public:
  /// Coefficients of x^2, y^2, z^2, x y, y z, z x, x, y, z and 1. Throws `Error` when a number is not finite, when
  /// there is no square or product, or when the polynomial is zero nowhere or only in a point, a line or a doubled
  /// plane.
  explicit Quadric(const std::array<double, 10>& coefficient);

  Vec3 project(Vec3 point) const override;
  Vec3 normal(Vec3 point) const override;
  double magnitude() const override;

 private:
  using Row = std::array<double, 3>;

  Row to_principal(Vec3 point) const;
  Vec3 from_principal(const Row& place) const;
  Row nearest(const Row& from) const;
  Row polished(Row place) const;
  Row gradient(const Row& place) const;
  double value(const Row& place) const;

  /// In its principal frame, whose axes are the columns of `axis_` and whose origin is `center_` (in that frame), the
  /// polynomial is sum(square_ y^2 + linear_ y) + constant_; of each pair square and linear one is zero.
  std::array<Row, 3> axis_{};
  Row center_{};
  Row square_{}, linear_{};
  double constant_ = 0;
};

}  // namespace pamr::geometry
