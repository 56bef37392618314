// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/meridian.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pamr::meshing {
namespace {

constexpr double overhang = 15e-3;

/// Half the chord of a circle at `along` from its center.
double half_chord(double radius, double along) { return std::sqrt(std::max(0.0, (radius - along) * (radius + along))); }

/// The shorter one about that center.
geometry::ProfileArc about(Meridian center) { return {center, {}}; }

}  // namespace

BluntConeMeridian::BluntConeMeridian(double around, double behind) : outflow_x(behind), outer_radius(around) {
  const double angle = 70.0 / 180.0 * std::numbers::pi;
  slope_ = std::tan(angle);
  nose_end = {nose_radius - nose_radius * std::sin(angle), nose_radius * std::cos(angle)};
  shoulder_center.r = max_radius - shoulder_radius;
  cone_end.r = shoulder_center.r + shoulder_radius * std::cos(angle);
  cone_end.x = nose_end.x + (cone_end.r - nose_end.r) / slope_;
  shoulder_center.x = cone_end.x + shoulder_radius * std::sin(angle);
  shoulder_end = {shoulder_center.x + shoulder_radius, shoulder_center.r};
  fillet_center = {shoulder_end.x + fillet_radius, sting_radius + fillet_radius};
  base_end = {shoulder_end.x, fillet_center.r};
  fillet_end = {fillet_center.x, sting_radius};
}

MeridianPath BluntConeMeridian::body() const {
  return {{{0, 0}, nose_end, about({nose_radius, 0})},      {nose_end, cone_end, {}},
          {cone_end, shoulder_end, about(shoulder_center)}, {shoulder_end, base_end, {}},
          {base_end, fillet_end, about(fillet_center)},     {fillet_end, {outflow_x + overhang, sting_radius}, {}}};
}

MeridianPath BluntConeMeridian::outer() const {
  const Meridian center{inflow_x + rounding_radius, outer_radius - rounding_radius};
  return {{{inflow_x, 0}, {inflow_x, center.r}, {}},
          {{inflow_x, center.r}, {center.x, outer_radius}, about(center)},
          {{center.x, outer_radius}, {outflow_x + overhang, outer_radius}, {}}};
}

bool BluntConeMeridian::is_in_body(Meridian p) const {
  if (p.x <= 0) return false;
  if (p.x <= nose_end.x) return p.r < half_chord(nose_radius, nose_radius - p.x);
  if (p.x <= cone_end.x) return p.r < nose_end.r + (p.x - nose_end.x) * slope_;
  if (p.x <= shoulder_end.x) return p.r < shoulder_center.r + half_chord(shoulder_radius, p.x - shoulder_center.x);
  if (p.x <= fillet_end.x) return p.r < fillet_center.r - half_chord(fillet_radius, fillet_center.x - p.x);
  return p.r < sting_radius;
}

bool BluntConeMeridian::is_beyond_outer(Meridian p) const {
  const double center_x = inflow_x + rounding_radius;
  if (p.x < inflow_x) return true;
  if (p.x >= center_x) return p.r > outer_radius;
  return p.r > outer_radius - rounding_radius + half_chord(rounding_radius, center_x - p.x);
}

std::vector<Meridian> sample(const MeridianPath& path, int n_line, int n_arc) {
  std::vector<Meridian> points{path.front().from};
  for (const auto& [from, to, arc] : path) {
    if (!arc) {
      for (int i = 1; i < n_line; ++i) points.push_back(from + static_cast<double>(i) / n_line * (to - from));
    } else {
      const Meridian center = arc->center;
      const double radius = std::hypot(from.x - center.x, from.r - center.r);
      const double begin = std::atan2(from.r - center.r, from.x - center.x);
      // The shorter way round: the difference of two angles, folded into half a turn.
      const double turn = std::remainder(std::atan2(to.r - center.r, to.x - center.x) - begin, 2 * std::numbers::pi);
      for (int i = 1; i < n_arc; ++i) {
        const double angle = begin + static_cast<double>(i) / n_arc * turn;
        points.push_back({center.x + radius * std::cos(angle), center.r + radius * std::sin(angle)});
      }
    }
    points.push_back(to);
  }
  return points;
}

}  // namespace pamr::meshing
