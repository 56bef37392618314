// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/geometry/axis.hpp"
#include "pamr/geometry/surface.hpp"

namespace pamr::geometry {

/// Ring torus; the normal points out of the tube. Points of the circle in the middle of the tube are projected away
/// from the axis.
class Torus final : public Surface {
 public:
  /// Major radius: of the circle in the middle of the tube; minor radius: of the tube. Throws `Error` unless
  /// 0 < minor_radius < major_radius, and when a number is not finite or the axis is zero.
  Torus(Vec3 center, Vec3 axis, double major_radius, double minor_radius);

  Vec3 project(Vec3 point) const override;
  Vec3 normal(Vec3 point) const override;
  double distance(Vec3 point) const override;
  double magnitude() const override;

 private:
  Meridian outward(Meridian at) const;

  Axis axis_;
  double major_radius_, minor_radius_;
};

}  // namespace pamr::geometry
