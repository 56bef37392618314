// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/revolution.hpp"

#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

Revolution::Revolution(Vec3 origin, Vec3 axis, const std::vector<ProfilePiece>& profile)
    : axis_(origin, axis), profile_(profile) {}

Vec3 Revolution::project(Vec3 point) const {
  const Axis::Place place = axis_.place(point);
  return axis_.point(profile_.nearest(place.at).point, place.radial);
}

Vec3 Revolution::normal(Vec3 point) const {
  const Axis::Place place = axis_.place(point);
  return axis_.vector(profile_.nearest(place.at).normal, place.radial);
}

Vec3 Revolution::project_to_seam(Vec3 point) const {
  const Axis::Place place = axis_.place(point);
  const auto joint = profile_.nearest_joint(place.at);
  return axis_.point(joint ? *joint : profile_.nearest(place.at).point, place.radial);
}

double Revolution::distance(Vec3 point) const { return profile_.nearest(axis_.place(point).at).distance; }

double Revolution::magnitude() const { return largest_coordinate(axis_.origin()) + profile_.magnitude(); }

}  // namespace pamr::geometry
