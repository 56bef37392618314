// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/sphere.hpp"

#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

Sphere::Sphere(Vec3 center, double radius)
    : center_(checked_point(center, "center")), radius_(checked_length(radius, "radius")) {}

Vec3 Sphere::project(Vec3 point) const { return center_ + radius_ * normal(point); }

Vec3 Sphere::normal(Vec3 point) const {
  const Vec3 out = point - center_;
  const double length = norm(out);
  if (!(length > min_length)) return {1, 0, 0};
  return {out.x / length, out.y / length, out.z / length};
}

double Sphere::distance(Vec3 point) const { return std::abs(norm(point - center_) - radius_); }

double Sphere::magnitude() const { return largest_coordinate(center_) + radius_; }

}  // namespace pamr::geometry
