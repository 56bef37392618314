// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/revolution.hpp"

#include <array>

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

std::optional<Vec3> Revolution::crease_between(Vec3 a, Vec3 b, Vec3 c, Vec3 d) const {
  if (!profile_.has_corners()) return std::nullopt;
  const Meridian from = axis_.place(a).at, to = axis_.place(b).at;
  const auto& corner = profile_.nearest_corner(from);
  const double near = 1e-6 * norm(b - a);
  if (!(norm(from - corner.point) <= near) || !(norm(to - corner.point) <= near)) return std::nullopt;
  const auto run = [&](Vec3 third) { return piece_at((1.0 / 3) * (a + b + third)); };
  const std::array<int, 2> sides{run(c), run(d)};
  if (sides != corner.run && sides != std::array{corner.run[1], corner.run[0]}) return std::nullopt;
  return axis_.point(corner.point, axis_.place(midpoint(a, b)).radial);
}

double Revolution::distance(Vec3 point) const { return profile_.nearest(axis_.place(point).at).distance; }

double Revolution::magnitude() const { return largest_coordinate(axis_.origin()) + profile_.magnitude(); }

}  // namespace pamr::geometry
