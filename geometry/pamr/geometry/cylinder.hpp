// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/geometry/axis.hpp"
#include "pamr/geometry/surface.hpp"

namespace pamr::geometry {

/// Circular cylinder without ends; the normal points away from the axis.
class Cylinder final : public Surface {
 public:
  /// Throws `Error` when a number is not finite, the axis is zero or the radius is not positive.
  Cylinder(Vec3 point, Vec3 axis, double radius);

  Vec3 project(Vec3 point) const override;
  Vec3 normal(Vec3 point) const override;
  double distance(Vec3 point) const override;
  double magnitude() const override;

 private:
  Axis axis_;
  double radius_;
};

}  // namespace pamr::geometry
