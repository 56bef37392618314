// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/plane.hpp"

#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

Plane::Plane(Vec3 point, Vec3 normal)
    : point_(checked_point(point, "point")), normal_(checked_direction(normal, "normal")) {}

Vec3 Plane::project(Vec3 point) const {
  const Vec3 near = point - dot(point - point_, normal_) * normal_;
  return near - dot(near - point_, normal_) * normal_;  // the second step removes the rounding of a long first one
}

Vec3 Plane::normal(Vec3 /*point*/) const { return normal_; }

double Plane::distance(Vec3 point) const { return std::abs(dot(point - point_, normal_)); }

double Plane::magnitude() const { return largest_coordinate(point_); }

}  // namespace pamr::geometry
