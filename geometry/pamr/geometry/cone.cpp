// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cone.hpp"

#include <algorithm>
#include <numbers>

#include "pamr/base/error.hpp"
#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

namespace {

Meridian generator_of(double half_angle) {
  if (!(half_angle > 0 && half_angle < 90))
    throw Error("half_angle: expected degrees between 0 and 90, found " + decimal(half_angle));
  const double angle = half_angle * (std::numbers::pi / 180.0);
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

Cone::Cone(Vec3 apex, Vec3 axis, double half_angle)
    : axis_(checked_point(apex, "apex"), axis), generator_(generator_of(half_angle)) {}

Vec3 Cone::project(Vec3 point) const {
  const Axis::Place place = axis_.place(point);
  const double along = std::max(0.0, dot(place.at, generator_));
  return axis_.point(along * generator_, place.radial);
}

Vec3 Cone::normal(Vec3 point) const { return axis_.vector({-generator_.r, generator_.x}, axis_.place(point).radial); }

double Cone::magnitude() const { return largest_coordinate(axis_.origin()); }

}  // namespace pamr::geometry
