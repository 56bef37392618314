// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/blunt_cone.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "meshing/meridian.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/described_surface.hpp"

namespace pamr::meshing {
namespace {

using geometry::Meridian, geometry::Vec3;

/// Pieces of the boundary and patches of the mesh, in this order.
enum PieceNumber { forebody, base, sting, inflow, outflow, symmetry };

Meridian meridian_point(Vec3 p) { return {p.x, std::hypot(p.y, p.z)}; }

/// Behind which part of the wall a point in the body lies. The borders between the three meet the wall in the circles
/// where the patches meet and nowhere else.
int wall_piece(const BluntConeMeridian& m, Meridian p) {
  if (p.x > m.fillet_end.x) return sting;
  if (p.x > m.base_end.x) return p.r < m.sting_radius ? sting : base;
  const double middle = 0.5 * (m.shoulder_end.x + p.r / m.shoulder_end.r * m.shoulder_end.x);
  return p.r < m.shoulder_end.r && p.x > middle ? base : forebody;
}

int label(const BluntConeMeridian& m, Vec3 point) {
  const auto p = meridian_point(point);
  if (m.is_beyond_outer(p)) return inflow;
  if (m.is_in_body(p)) return wall_piece(m, p);
  if (point.y < 0) return symmetry;
  return point.x > m.outflow_x ? outflow : Domain::inside;
}

double distance_to_segment(Meridian p, Meridian a, Meridian b) {
  const double dx = b.x - a.x, dr = b.r - a.r;
  const double t = std::clamp(((p.x - a.x) * dx + (p.r - a.r) * dr) / (dx * dx + dr * dr), 0.0, 1.0);
  return std::hypot(p.x - a.x - t * dx, p.r - a.r - t * dr);
}

/// The finest of the parts of the wall, each seen from here; arcs as two chords. A size holds to one edge length from
/// its part, so that edges that leave an arc are as short as those on it.
double size_at(const BluntConeMeridian& m, const BluntConeSizes& s, Vec3 point) {
  const auto p = meridian_point(point);
  const Meridian top{m.shoulder_center.x, m.max_radius};
  double size = s.far;
  const auto grow = [&](double here, Meridian a, Meridian b) {
    size = std::min(size, here + s.growth * std::max(0.0, distance_to_segment(p, a, b) - here));
  };
  grow(s.forebody, {0, 0}, m.nose_end);
  grow(s.forebody, m.nose_end, m.cone_end);
  grow(s.shoulder, m.cone_end, top);
  grow(s.shoulder, top, m.shoulder_end);
  grow(s.base, m.shoulder_end, m.base_end);
  grow(s.fillet, m.base_end, m.fillet_end);
  grow(s.sting, m.fillet_end, {m.outflow_x, m.sting_radius});
  return size;
}

/// A step of the meridian as a curve in the symmetry plane: `side` 1 or -1 for z > 0 or z < 0.
std::vector<Vec3> in_plane(const MeridianPath& profile, double side) {
  std::vector<Vec3> points;
  for (const auto& p : sample(profile, 100, 200)) points.push_back({p.x, 0, p.r == 0 ? 0 : side * p.r});
  return points;
}

/// A profile that starts on the axis, both its sides as one smooth curve.
std::vector<Vec3> across_axis(const MeridianPath& profile) {
  auto points = in_plane(profile, -1);
  std::reverse(points.begin(), points.end());
  const auto other = in_plane(profile, 1);
  points.insert(points.end(), other.begin() + 1, other.end());
  return points;
}

/// Half circle about the axis, from z < 0 over y > 0 to z > 0.
FeatureCurve ring(Meridian at) {
  constexpr int n = 1000;
  FeatureCurve curve;
  curve.polyline.push_back({at.x, 0, -at.r});
  for (int i = 1; i < n; ++i) {
    const double t = std::numbers::pi * i / n;
    curve.polyline.push_back({at.x, at.r * std::sin(t), -at.r * std::cos(t)});
  }
  curve.polyline.push_back({at.x, 0, at.r});
  curve.nearest = [at](Vec3 p) {
    const double scale = at.r / std::hypot(p.y, p.z);
    return Vec3{at.x, scale * p.y, scale * p.z};
  };
  return curve;
}

/// The same profile with its last step cut at `x`.
MeridianPath cut_at(MeridianPath profile, double x) {
  profile.back().to.x = x;
  return profile;
}

std::vector<FeatureCurve> feature_curves(const BluntConeMeridian& m, const Nearest& body, const Nearest& outer) {
  const auto in_symmetry_plane = [](const Nearest& surface) -> Nearest {
    return [surface](Vec3 p) {
      const Vec3 q = surface({p.x, 0, p.z});
      return Vec3{q.x, 0, q.z};
    };
  };
  const auto body_curve = in_symmetry_plane(body);
  const auto wall = cut_at(m.body(), m.outflow_x);
  const auto part = [&wall](std::ptrdiff_t begin, std::ptrdiff_t end) {
    return MeridianPath(wall.begin() + begin, wall.begin() + end);
  };
  const MeridianPath end{{{m.outflow_x, m.sting_radius}, {m.outflow_x, m.outer_radius}, {}}};
  std::vector<FeatureCurve> curves;
  curves.push_back({across_axis(part(0, 3)), body_curve});
  for (const double side : {-1.0, 1.0}) {
    curves.push_back({in_plane(part(3, 5), side), body_curve});
    curves.push_back({in_plane(part(5, 6), side), body_curve});
    curves.push_back({in_plane(end, side), [x = m.outflow_x](Vec3 p) { return Vec3{x, 0, p.z}; }});
  }
  curves.push_back({across_axis(cut_at(m.outer(), m.outflow_x)), in_symmetry_plane(outer)});
  curves.push_back(ring(m.shoulder_end));
  curves.push_back(ring(m.fillet_end));
  curves.push_back(ring({m.outflow_x, m.sting_radius}));
  curves.push_back(ring({m.outflow_x, m.outer_radius}));
  return curves;
}

constexpr double finest = 1e-4;
constexpr std::array<SizeLimit, 7> limits{{{"far", &BluntConeSizes::far, finest, 15e-3},
                                           {"forebody", &BluntConeSizes::forebody, finest, 6e-3},
                                           {"shoulder", &BluntConeSizes::shoulder, finest, 0.9e-3},
                                           {"base", &BluntConeSizes::base, finest, 6e-3},
                                           {"fillet", &BluntConeSizes::fillet, finest, 1.25e-3},
                                           {"sting", &BluntConeSizes::sting, finest, 3.8e-3},
                                           {"growth", &BluntConeSizes::growth, 0.05, 0.8}}};
constexpr std::array<GeometryLimit, 2> geometry_limits{{{"outer_radius", &BluntConeGeometry::outer_radius, 45e-3, 0.2},
                                                        {"outflow", &BluntConeGeometry::outflow, 20e-3, 0.2}}};

template <typename Limits, typename Values>
void require_within(const Limits& ranges, const Values& values, const char* kind) {
  for (const auto& range : ranges)
    if (const double value = values.*range.value; !(value >= range.low && value <= range.high))
      throw Error(fmt::format("expected {}{} of blunt-cone between {:g} and {:g}, found {:g}", kind, range.name,
                              range.low, range.high, value));
}

}  // namespace

BluntConeSizes BluntConeSizes::scaled_to(double far) {
  BluntConeSizes s;
  const double factor = far / s.far, on_arcs = std::min(1.0, factor);
  s.far = far;
  s.forebody *= factor;
  s.base *= factor;
  s.shoulder *= on_arcs;
  s.fillet *= on_arcs;
  s.sting *= on_arcs;
  return s;
}

std::span<const SizeLimit> blunt_cone_size_limits() { return limits; }
std::span<const GeometryLimit> blunt_cone_geometry_limits() { return geometry_limits; }

Domain blunt_cone(const BluntConeSizes& sizes, const BluntConeGeometry& geometry) {
  require_within(limits, sizes, "size ");
  require_within(geometry_limits, geometry, "");
  const BluntConeMeridian m(geometry.outer_radius, geometry.outflow);
  Domain domain;
  const std::array described{
      geometry::described_revolution("body", m.body()), geometry::described_revolution("outer", m.outer()),
      geometry::described_plane("outflow", 0, m.outflow_x), geometry::described_plane("symmetry", 1, 0.0)};
  domain.surfaces = std::make_shared<const geometry::SurfaceSet>(geometry::set_of(described, "blunt-cone"));
  const auto nearest = [surfaces = domain.surfaces](const char* name) -> Nearest {
    return [surfaces, surface = surfaces->find(name)](Vec3 p) { return surface->project(p); };
  };
  const Nearest body = nearest("body"), outer = nearest("outer");
  domain.label = [m](Vec3 p) { return label(m, p); };
  domain.size = [m, sizes](Vec3 p) { return size_at(m, sizes, p); };
  domain.pieces = {{forebody, body},
                   {base, body},
                   {sting, body},
                   {inflow, outer},
                   {outflow,
                    [x = m.outflow_x](Vec3 p) {
                      return Vec3{x, p.y, p.z};
                    }},
                   {symmetry, [](Vec3 p) {
                      return Vec3{p.x, 0, p.z};
                    }}};
  domain.curves = feature_curves(m, body, outer);
  domain.patches = {{"forebody", "patch", 0}, {"base", "patch", 0},    {"sting", "patch", 0},
                    {"inflow", "patch", 1},   {"outflow", "patch", 2}, {"symmetry", "patch", 3}};
  domain.length_unit = std::string("m");
  domain.center = {0.5 * (m.inflow_x + m.outflow_x), 0, 0};
  domain.radius = 1.2 * std::hypot(m.outer_radius, domain.center.x - m.inflow_x);
  return domain;
}

}  // namespace pamr::meshing
