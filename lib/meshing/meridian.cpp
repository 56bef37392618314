// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/meridian.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pamr::meshing {
namespace {

constexpr double overhang = 15e-3;

/// Half the chord of a circle at `along` from its center.
double half_chord(double radius, double along) { return std::sqrt(std::max(0.0, (radius - along) * (radius + along))); }

std::string step_toml(const ProfileStep& s) {
  const auto ends =
      fmt::format("from = [{:.17g}, {:.17g}], to = [{:.17g}, {:.17g}]", s.from.x, s.from.r, s.to.x, s.to.r);
  return s.is_arc ? fmt::format("  {{{}, center = [{:.17g}, {:.17g}]}}", ends, s.center.x, s.center.r)
                  : fmt::format("  {{{}}}", ends);
}

}  // namespace

BluntConeMeridian::BluntConeMeridian() {
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

Profile BluntConeMeridian::body() const {
  return {{{0, 0}, nose_end, true, {nose_radius, 0}},      {nose_end, cone_end},
          {cone_end, shoulder_end, true, shoulder_center}, {shoulder_end, base_end},
          {base_end, fillet_end, true, fillet_center},     {fillet_end, {outflow_x + overhang, sting_radius}}};
}

Profile BluntConeMeridian::outer() const {
  const MeridianPoint center{inflow_x + rounding_radius, outer_radius - rounding_radius};
  return {{{inflow_x, 0}, {inflow_x, center.r}},
          {{inflow_x, center.r}, {center.x, outer_radius}, true, center},
          {{center.x, outer_radius}, {outflow_x + overhang, outer_radius}}};
}

bool BluntConeMeridian::is_in_body(MeridianPoint p) const {
  if (p.x <= 0) return false;
  if (p.x <= nose_end.x) return p.r < half_chord(nose_radius, nose_radius - p.x);
  if (p.x <= cone_end.x) return p.r < nose_end.r + (p.x - nose_end.x) * slope_;
  if (p.x <= shoulder_end.x) return p.r < shoulder_center.r + half_chord(shoulder_radius, p.x - shoulder_center.x);
  if (p.x <= fillet_end.x) return p.r < fillet_center.r - half_chord(fillet_radius, fillet_center.x - p.x);
  return p.r < sting_radius;
}

bool BluntConeMeridian::is_beyond_outer(MeridianPoint p) const {
  const double center_x = inflow_x + rounding_radius;
  if (p.x < inflow_x) return true;
  if (p.x >= center_x) return p.r > outer_radius;
  return p.r > outer_radius - rounding_radius + half_chord(rounding_radius, center_x - p.x);
}

std::vector<MeridianPoint> sample(const Profile& profile, int n_line, int n_arc) {
  std::vector<MeridianPoint> points{profile.front().from};
  for (const auto& s : profile) {
    const int n = s.is_arc ? n_arc : n_line;
    const double radius = std::hypot(s.from.x - s.center.x, s.from.r - s.center.r);
    const double begin = std::atan2(s.from.r - s.center.r, s.from.x - s.center.x);
    // The shorter way round: the difference of two angles, folded into half a turn.
    const double turn =
        std::remainder(std::atan2(s.to.r - s.center.r, s.to.x - s.center.x) - begin, 2 * std::numbers::pi);
    for (int i = 1; i < n; ++i) {
      const double t = static_cast<double>(i) / n;
      if (s.is_arc)
        points.push_back(
            {s.center.x + radius * std::cos(begin + t * turn), s.center.r + radius * std::sin(begin + t * turn)});
      else
        points.push_back({s.from.x + t * (s.to.x - s.from.x), s.from.r + t * (s.to.r - s.from.r)});
    }
    points.push_back(s.to);
  }
  return points;
}

std::string revolution_toml(const std::string& name, const Profile& profile) {
  std::string text = fmt::format(
      "[[surface]]\nname = \"{}\"\nkind = \"revolution\"\norigin = [0.0, 0.0, 0.0]\naxis = [1.0, 0.0, 0.0]\n"
      "profile = [\n",
      name);
  for (std::size_t i = 0; i < profile.size(); ++i)
    text += step_toml(profile[i]) + (i + 1 < profile.size() ? ",\n" : "\n");
  return text + "]\n";
}

std::string plane_toml(const std::string& name, int axis, double at) {
  const auto component = [axis](int i, double value) { return i == axis ? value : 0.0; };
  return fmt::format(
      "[[surface]]\nname = \"{}\"\nkind = \"plane\"\npoint = [{:.17g}, {:.17g}, {:.17g}]\n"
      "normal = [{:.17g}, {:.17g}, {:.17g}]\n",
      name, component(0, at), component(1, at), component(2, at), component(0, 1), component(1, 1), component(2, 1));
}

}  // namespace pamr::meshing
