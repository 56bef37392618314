// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/geometry/axis.hpp"
#include "pamr/geometry/profile.hpp"
#include "pamr/geometry/surface.hpp"

namespace pamr::geometry {

/// Surface of revolution: a chain of line segments and circular arcs in the (x, r) half plane, turned about an axis.
/// The normal points to the left of the direction in which the profile is travelled (x to the right, r upwards): away
/// from the axis where x grows. It is continuous over tangent joints. In a corner it is that of the first of the
/// pieces that meet there.
class Revolution final : public Surface, public Creases {
 public:
  /// x is counted from the origin along the axis. Throws `Error` as `Profile` does, and when a number is not finite or
  /// the axis is zero.
  Revolution(Vec3 origin, Vec3 axis, const std::vector<ProfilePiece>& profile);

  Vec3 project(Vec3 point) const override;
  Vec3 normal(Vec3 point) const override;
  Vec3 project_to_seam(Vec3 point) const override;
  const Creases* creases() const override { return profile_.has_corners() ? this : nullptr; }
  int piece_at(Vec3 point) const override { return profile_.run_at(axis_.place(point).at); }
  std::optional<Vec3> crease_between(Vec3 a, Vec3 b, Vec3 c, Vec3 d) const override;
  double distance(Vec3 point) const override;
  bool is_flat() const override { return profile_.is_disc(); }
  double magnitude() const override;

  /// Area of the full turn, exact but for rounding.
  double area() const { return profile_.area(); }
  /// Volume between the surface and the axis, cut off by the planes through the ends of the profile: the volume inside
  /// a profile that starts and ends on the axis or is closed. Positive when the normal points out of it. Exact but for
  /// rounding.
  double volume() const { return profile_.volume(); }

 private:
  Axis axis_;
  Profile profile_;
};

}  // namespace pamr::geometry
