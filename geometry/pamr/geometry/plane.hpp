// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/geometry/surface.hpp"

namespace pamr::geometry {

/// The whole plane through a point; the normal is the given one, made unit.
class Plane final : public Surface {
 public:
  /// Throws `Error` when a number is not finite or the normal is zero.
  Plane(Vec3 point, Vec3 normal);

  Vec3 project(Vec3 point) const override;
  Vec3 normal(Vec3 point) const override;
  double distance(Vec3 point) const override;
  bool is_flat() const override { return true; }
  double magnitude() const override;

 private:
  Vec3 point_, normal_;
};

}  // namespace pamr::geometry
