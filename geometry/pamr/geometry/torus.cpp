// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/torus.hpp"

#include "pamr/base/error.hpp"
#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

Torus::Torus(Vec3 center, Vec3 axis, double major_radius, double minor_radius)
    : axis_(checked_point(center, "center"), axis),
      major_radius_(checked_length(major_radius, "major_radius")),
      minor_radius_(checked_length(minor_radius, "minor_radius")) {
  if (!(minor_radius < major_radius))
    throw Error("minor_radius: expected less than the major radius " + decimal(major_radius) + ", found " +
                decimal(minor_radius));
}

Meridian Torus::outward(Meridian at) const {
  const Meridian out = at - Meridian{0, major_radius_};
  const double length = norm(out);
  if (!(length > min_length)) return {0, 1};
  return {out.x / length, out.r / length};
}

Vec3 Torus::project(Vec3 point) const {
  const Axis::Place place = axis_.place(point);
  return axis_.point(Meridian{0, major_radius_} + minor_radius_ * outward(place.at), place.radial);
}

Vec3 Torus::normal(Vec3 point) const {
  const Axis::Place place = axis_.place(point);
  return axis_.vector(outward(place.at), place.radial);
}

double Torus::distance(Vec3 point) const {
  return std::abs(norm(axis_.place(point).at - Meridian{0, major_radius_}) - minor_radius_);
}

double Torus::magnitude() const { return largest_coordinate(axis_.origin()) + major_radius_ + minor_radius_; }

}  // namespace pamr::geometry
