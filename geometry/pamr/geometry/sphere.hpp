// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/geometry/surface.hpp"

namespace pamr::geometry {

/// Sphere; the normal points away from the center. The center itself is projected in direction +x.
class Sphere final : public Surface {
 public:
  /// Throws `Error` when a number is not finite or the radius is not positive.
  Sphere(Vec3 center, double radius);

  Vec3 project(Vec3 point) const override;
  Vec3 normal(Vec3 point) const override;
  double distance(Vec3 point) const override;
  double magnitude() const override;

 private:
  Vec3 center_;
  double radius_;
};

}  // namespace pamr::geometry
