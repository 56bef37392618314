// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/sphere_in_box.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "pamr/base/error.hpp"
#include "pamr/geometry/described_surface.hpp"

namespace pamr::meshing {
namespace {

using geometry::Vec3;

constexpr double half_side = 2.0;
/// Wanted edge length per size, which bounds the radius of the ball through the corners of a cell.
constexpr double edge_per_size = 1.17;
constexpr int sphere_piece = 6;  // 0 .. 5 are the sides xmin xmax ymin ymax zmin zmax

using Point = std::array<double, 3>;

Vec3 to_vec(const Point& p) { return {p[0], p[1], p[2]}; }
Point to_point(Vec3 p) { return {p.x, p.y, p.z}; }

/// `p` with its coordinates along the given axes set.
Vec3 with(Vec3 p, std::size_t axis, double value) {
  auto q = to_point(p);
  q[axis] = value;
  return to_vec(q);
}

int label(Vec3 p) {
  if (squared_norm(p) < 1) return sphere_piece;
  const auto q = to_point(p);
  std::size_t farthest = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (std::abs(q[i]) > std::abs(q[farthest])) farthest = i;
  if (std::abs(q[farthest]) <= half_side) return Domain::inside;
  return static_cast<int>(2 * farthest) + (q[farthest] > 0 ? 1 : 0);
}

/// The edge of the cube along `axis` on the given sides of the other two.
FeatureCurve edge(std::size_t axis, double first, double second) {
  const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
  const auto nearest = [a, b, first, second](Vec3 p) { return with(with(p, a, first), b, second); };
  FeatureCurve curve;
  for (const double end : {-half_side, half_side}) curve.polyline.push_back(nearest(with({}, axis, end)));
  curve.nearest = nearest;
  return curve;
}

}  // namespace

Domain sphere_in_box(double size) {
  if (!(size >= box_size_limits.low && size <= box_size_limits.high))
    throw Error(fmt::format("expected an edge length between {:g} and {:g} for sphere-in-box, found {:g}",
                            box_size_limits.low, box_size_limits.high, size));
  Domain domain;
  domain.label = label;
  domain.size = [size](Vec3) { return edge_per_size * size; };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double side : {-half_side, half_side})
      domain.pieces.push_back({0, [axis, side](Vec3 p) { return with(p, axis, side); }});
  domain.pieces.push_back({1, [](Vec3 p) { return 1 / norm(p) * p; }});
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double first : {-half_side, half_side})
      for (const double second : {-half_side, half_side}) domain.curves.push_back(edge(axis, first, second));
  domain.patches = {{"box", "patch"}, {"sphere", "patch", 0}};
  const std::array sphere{geometry::described_sphere("sphere", geometry::whole(Vec3{}), geometry::whole(1))};
  domain.surfaces = std::make_shared<const geometry::SurfaceSet>(geometry::set_of(sphere, "sphere-in-box"));
  domain.length_unit = std::string("1");
  domain.radius = 1.05 * std::sqrt(3.0) * half_side;
  return domain;
}

}  // namespace pamr::meshing
