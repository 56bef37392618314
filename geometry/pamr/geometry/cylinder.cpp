// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cylinder.hpp"

#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

Cylinder::Cylinder(Vec3 point, Vec3 axis, double radius)
    : axis_(checked_point(point, "point"), axis), radius_(checked_length(radius, "radius")) {}

Vec3 Cylinder::project(Vec3 point) const {
  const Axis::Place place = axis_.place(point);
  return axis_.point({place.at.x, radius_}, place.radial);
}

Vec3 Cylinder::normal(Vec3 point) const { return axis_.place(point).radial; }

double Cylinder::distance(Vec3 point) const { return std::abs(axis_.place(point).at.r - radius_); }

double Cylinder::magnitude() const { return largest_coordinate(axis_.origin()) + radius_; }

}  // namespace pamr::geometry
