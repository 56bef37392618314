// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/geometry/axis.hpp"
#include "pamr/geometry/surface.hpp"

namespace pamr::geometry {

/// One nappe of a circular cone: the apex and all points in direction of the axis from it, without end. The normal
/// points away from the axis. Points behind the apex have the apex as nearest point; there the normal is that of the
/// generator in their own meridian half plane.
class Cone final : public Surface {
 public:
  /// The angle between axis and generators is in degrees, in (0, 90). Throws `Error` otherwise, and when a number is
  /// not finite or the axis is zero.
  Cone(Vec3 apex, Vec3 axis, double half_angle);

  Vec3 project(Vec3 point) const override;
  Vec3 normal(Vec3 point) const override;
  double magnitude() const override;

 private:
  Axis axis_;
  Meridian generator_;
};

}  // namespace pamr::geometry
