// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// Point or vector of a meridian half plane: x along the axis, r away from it.
struct Meridian {
  double x = 0, r = 0;

  friend constexpr Meridian operator+(Meridian a, Meridian b) { return {a.x + b.x, a.r + b.r}; }
  friend constexpr Meridian operator-(Meridian a, Meridian b) { return {a.x - b.x, a.r - b.r}; }
  friend constexpr Meridian operator*(double s, Meridian a) { return {s * a.x, s * a.r}; }
  friend constexpr bool operator==(Meridian a, Meridian b) = default;
};
constexpr double dot(Meridian a, Meridian b) { return a.x * b.x + a.r * b.r; }
/// Positive when b points to the left of a (x to the right, r upwards).
constexpr double cross(Meridian a, Meridian b) { return a.x * b.r - a.r * b.x; }
inline double norm(Meridian a) { return std::sqrt(dot(a, a)); }

/// Axis of a rotationally symmetric surface. The point of such a surface nearest to p lies in the meridian half plane
/// through p, so the surface needs to know that half plane only.
class Axis {
 public:
  /// Throws `Error` for a point or direction that is not finite, or a zero direction.
  Axis(Vec3 origin, Vec3 direction);

  /// The half plane through a point and the place of the point in it. On the axis itself `radial` is a fixed unit
  /// vector perpendicular to the axis.
  struct Place {
    Meridian at;
    Vec3 radial;
  };
  Place place(Vec3 point) const;

  /// The point at a place of the half plane.
  Vec3 point(Meridian at, Vec3 radial) const { return origin_ + vector(at, radial); }
  /// The vector with these components in the half plane.
  Vec3 vector(Meridian v, Vec3 radial) const { return v.x * direction_ + v.r * radial; }
  Vec3 origin() const { return origin_; }
  Vec3 direction() const { return direction_; }

 private:
  Vec3 origin_, direction_, side_;
};

}  // namespace pamr::geometry
