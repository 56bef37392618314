// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/curve_trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pamr/base/error.hpp"

namespace pamr::meshing {
namespace {

using geometry::Vec3;

constexpr double min_sine = 0.0872;  // 5 degrees: below, `project_onto_all` takes one of the surfaces alone
constexpr double max_turn = 0.01;    // radians from point to point
constexpr double max_kink = 0.3;     // radians where triangles of one smooth piece join: their curves have kinks there
constexpr double on_curve = 1e-10;   // of the solid's radius
constexpr std::size_t max_points = 1000000;

double distance_to_segment(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 ab = b - a;
  const double square = geometry::squared_norm(ab);
  const double t = square > 0 ? std::clamp(geometry::dot(p - a, ab) / square, 0.0, 1.0) : 0.0;
  return geometry::norm(p - a - t * ab);
}

bool lies_on(const CommonCurve::Trace& trace, Vec3 p, double tolerance) {
  for (std::size_t i = 0; i + 1 < trace.point.size(); ++i) {
    const Vec3 a = trace.point[i], b = trace.point[i + 1];
    if (distance_to_segment(p, a, b) < tolerance + 0.02 * geometry::norm(b - a)) return true;
  }
  return false;
}

}  // namespace

CommonCurve::Found CommonCurve::project(Vec3 p) const {
  const auto found = geometry::project_onto_all(shape_, p);
  if (!found.converged || geometry::distance_from_all(shape_, found.point) > on_curve * solid_->radius())
    return {p, false};
  return {solid_->on_planes(std::array{a_, b_}, found.point), true};
}

Vec3 CommonCurve::tangent(Vec3 p) const { return geometry::cross(shape_[0]->normal(p), shape_[1]->normal(p)); }

bool CommonCurve::is_beyond(Vec3 p) const {
  const double margin = 0.02 * solid_->radius();
  const Vec3 below = solid_->low - p, above = p - solid_->high;
  return std::max({below.x, below.y, below.z, above.x, above.y, above.z}) > margin;
}

bool CommonCurve::is_triangulated(Vec3 p) const {
  return std::any_of(shape_.begin(), shape_.end(), [p](const auto* shape) { return shape->facet_deviation(p) > 0; });
}

bool CommonCurve::follow(std::vector<Vec3>& points, double sense) const {
  const double longest = solid_->radius() / 100, shortest = 1e-7 * solid_->radius();
  double step = 0.1 * longest;
  while (points.size() < max_points) {
    const Vec3 here = points.back(), t = tangent(here);
    const double sine = geometry::norm(t);
    if (sine < min_sine) return false;
    const Vec3 along = sense / sine * t;
    const auto next = project(here + step * along);
    const Vec3 then = tangent(next.point);
    const double turn = geometry::norm(geometry::cross(along, then)) / std::max(geometry::norm(then), min_sine);
    const bool goes_on = next.is_on_curve && sense * geometry::dot(along, then) > 0 &&
                         geometry::dot(next.point - here, along) > 0.5 * step;
    const bool is_kink = step < shortest && turn < max_kink && is_triangulated(here);
    if (!goes_on || (turn > max_turn && !is_kink)) {
      if (step < shortest) return false;
      step *= 0.5;
      continue;
    }
    const Vec3 first = points.front();
    if (points.size() > 2 && geometry::norm(first - here) < 2 * step && geometry::dot(first - here, along) > 0 &&
        geometry::dot(first - next.point, then) * sense <= 0) {
      points.push_back(first);
      return true;
    }
    points.push_back(next.point);
    if (is_beyond(next.point)) return false;
    if (turn < 0.5 * max_turn) step = std::min(2 * step, longest);
  }
  throw Error(fmt::format("expected surfaces {} and {} to meet in a curve, found one without an end", solid_->name(a_),
                          solid_->name(b_)));
}

CommonCurve::Trace CommonCurve::trace_from(Vec3 start) const {
  Trace result;
  result.point = {start};
  result.is_closed = follow(result.point, 1);
  if (result.is_closed) return result;
  std::vector<Vec3> back{start};
  follow(back, -1);
  std::reverse(back.begin(), back.end());
  back.pop_back();
  result.point.insert(result.point.begin(), back.begin(), back.end());
  return result;
}

std::vector<CommonCurve::Trace> CommonCurve::trace(const std::vector<Vec3>& starts) const {
  std::vector<Trace> result;
  const double near = solid_->radius() / 12;
  for (const Vec3 start : starts) {
    if (shape_[0]->distance(start) > near || shape_[1]->distance(start) > near) continue;
    const auto found = project(start);
    if (!found.is_on_curve || is_beyond(found.point)) continue;
    const double tolerance = 1e-6 * solid_->radius();
    if (std::any_of(result.begin(), result.end(), [&](const Trace& t) { return lies_on(t, found.point, tolerance); }))
      continue;
    auto trace = trace_from(found.point);
    if (trace.point.size() > 1) result.push_back(std::move(trace));
  }
  return result;
}

}  // namespace pamr::meshing
