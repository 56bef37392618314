// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/axis.hpp"

#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

namespace {

/// Unit vector perpendicular to the direction, made from the coordinate axis that is farthest from it (the first among
/// equals).
Vec3 side_of(Vec3 direction) {
  const double x = std::abs(direction.x), y = std::abs(direction.y), z = std::abs(direction.z);
  const Vec3 least = x <= y && x <= z ? Vec3{1, 0, 0} : (y <= z ? Vec3{0, 1, 0} : Vec3{0, 0, 1});
  return checked_direction(least - dot(least, direction) * direction, "side");
}

}  // namespace

Axis::Axis(Vec3 origin, Vec3 direction)
    : origin_(checked_point(origin, "origin")),
      direction_(checked_direction(direction, "axis")),
      side_(side_of(direction_)) {}

Axis::Place Axis::place(Vec3 point) const {
  const Vec3 from_origin = point - origin_;
  const double x = dot(from_origin, direction_);
  Vec3 away = from_origin - x * direction_;
  away = away - dot(away, direction_) * direction_;  // once more: the first difference may cancel near the axis
  const double r = norm(away);
  if (!(r > min_length)) return {{x, 0}, side_};
  return {{x, r}, {away.x / r, away.y / r, away.z / r}};
}

}  // namespace pamr::geometry
