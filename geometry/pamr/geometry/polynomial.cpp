// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/polynomial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

namespace {

constexpr int grid = 4;  ///< steps of the grid of starting points in each direction
constexpr int iteration_limit = 60;

Vec3 point_at(const PolynomialSegment& s, double u, double v) {
  const auto& c = s.coefficient;
  return c[0] + u * (c[1] + u * c[3] + v * c[4]) + v * (c[2] + v * c[5]);
}
Vec3 slope_u(const PolynomialSegment& s, double u, double v) {
  return s.coefficient[1] + (2 * u) * s.coefficient[3] + v * s.coefficient[4];
}
Vec3 slope_v(const PolynomialSegment& s, double u, double v) {
  return s.coefficient[2] + u * s.coefficient[4] + (2 * v) * s.coefficient[5];
}

/// Half the squared distance from a target as a function of (u, v), with what Newton's method needs.
struct Descent {
  double half_squared = 0;
  double gu = 0, gv = 0;             ///< gradient
  double huu = 0, huv = 0, hvv = 0;  ///< Hessian
  double guu = 0, guv = 0, gvv = 0;  ///< its part that is never negative (Gauss-Newton)
};

Descent look(const PolynomialSegment& s, Vec3 target, double u, double v) {
  const Vec3 off = point_at(s, u, v) - target, du = slope_u(s, u, v), dv = slope_v(s, u, v);
  Descent d;
  d.half_squared = 0.5 * squared_norm(off);
  d.gu = dot(off, du);
  d.gv = dot(off, dv);
  d.guu = dot(du, du);
  d.guv = dot(du, dv);
  d.gvv = dot(dv, dv);
  d.huu = d.guu + 2 * dot(off, s.coefficient[3]);
  d.huv = d.guv + dot(off, s.coefficient[4]);
  d.hvv = d.gvv + 2 * dot(off, s.coefficient[5]);
  return d;
}

bool is_blocked(double parameter, const std::array<double, 2>& range, double gradient) {
  return (parameter <= range[0] && gradient > 0) || (parameter >= range[1] && gradient < 0) || range[0] == range[1];
}

/// What is left to descend inside the rectangle.
double free_gradient(const PolynomialSegment& s, const Descent& d, double u, double v) {
  return std::hypot(is_blocked(u, s.u, d.gu) ? 0.0 : d.gu, is_blocked(v, s.v, d.gv) ? 0.0 : d.gv);
}

/// Newton's step where the Hessian is positive, Gauss-Newton's elsewhere; parameters that stand at their bound and want
/// to leave stay.
std::array<double, 2> step_of(const PolynomialSegment& s, const Descent& d, double u, double v) {
  const bool fix_u = is_blocked(u, s.u, d.gu), fix_v = is_blocked(v, s.v, d.gv);
  const auto along = [](double g, double h, double gauss) { return h > 0 ? -g / h : gauss > 0 ? -g / gauss : 0.0; };
  if (fix_u && fix_v) return {0, 0};
  if (fix_u) return {0, along(d.gv, d.hvv, d.gvv)};
  if (fix_v) return {along(d.gu, d.huu, d.guu), 0};
  const auto solve = [&d](double a, double b, double c) {
    const double determinant = a * c - b * b;
    return std::array{(b * d.gv - c * d.gu) / determinant, (b * d.gu - a * d.gv) / determinant};
  };
  if (d.huu > 0 && d.huu * d.hvv - d.huv * d.huv > 1e-12 * d.guu * d.gvv) return solve(d.huu, d.huv, d.hvv);
  const double damping = 1e-6 * (d.guu + d.gvv);
  return damping > 0 ? solve(d.guu + damping, d.guv, d.gvv + damping) : std::array{0.0, 0.0};
}

/// Descends from (u, v) to a local minimum inside the rectangle.
std::array<double, 2> descend(const PolynomialSegment& s, Vec3 target, double u, double v) {
  auto here = look(s, target, u, v);
  for (int iteration = 0; iteration < iteration_limit; ++iteration) {
    const auto [du, dv] = step_of(s, here, u, v);
    bool moved = false;
    for (double factor = 1; factor > 1e-3; factor *= 0.5) {
      const double next_u = std::clamp(u + factor * du, s.u[0], s.u[1]);
      const double next_v = std::clamp(v + factor * dv, s.v[0], s.v[1]);
      if (next_u == u && next_v == v) break;
      const auto next = look(s, target, next_u, next_v);
      // near the minimum rounding hides the descent, but not the fall of the gradient
      const bool is_lower = next.half_squared < here.half_squared ||
                            (next.half_squared <= here.half_squared * (1 + 1e-13) &&
                             free_gradient(s, next, next_u, next_v) < 0.5 * free_gradient(s, here, u, v));
      if (!is_lower) continue;
      u = next_u;
      v = next_v;
      here = next;
      moved = true;
      break;
    }
    if (!moved) break;
  }
  return {u, v};
}

double on_grid(const std::array<double, 2>& range, int i) {
  return i == grid ? range[1] : range[0] + (range[1] - range[0]) * i / grid;
}

/// Calls `visit(u, v)` at every grid point that is no farther from the target than its neighbors on the grid.
template <class Visit>
void for_each_start(const PolynomialSegment& s, Vec3 target, Visit&& visit) {
  std::array<std::array<double, grid + 1>, grid + 1> squared{};
  for (int i = 0; i <= grid; ++i)
    for (int j = 0; j <= grid; ++j)
      squared[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
          squared_norm(point_at(s, on_grid(s.u, i), on_grid(s.v, j)) - target);
  for (int i = 0; i <= grid; ++i)
    for (int j = 0; j <= grid; ++j) {
      bool is_least = true;
      for (int p = std::max(0, i - 1); p <= std::min(grid, i + 1); ++p)
        for (int q = std::max(0, j - 1); q <= std::min(grid, j + 1); ++q)
          is_least = is_least && squared[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] <=
                                     squared[static_cast<std::size_t>(p)][static_cast<std::size_t>(q)];
      if (is_least) visit(on_grid(s.u, i), on_grid(s.v, j));
    }
}

void check(const PolynomialSegment& s, std::size_t number) {
  const std::string where = fmt::format("segment {}: ", number + 1);
  for (const auto c : s.coefficient)
    if (!std::isfinite(c.x) || !std::isfinite(c.y) || !std::isfinite(c.z))
      throw Error(where + "expected finite coefficients, found " + decimal(c));
  for (const auto& [name, range] : {std::pair{"u", s.u}, std::pair{"v", s.v}})
    if (!(range[0] < range[1]) || !std::isfinite(range[0]) || !std::isfinite(range[1]))
      throw Error(where + name + ": expected two numbers, the greater one last, found " + decimal(range[0]) + " and " +
                  decimal(range[1]));
  double area = 0, size = 0;
  for (int i = 0; i <= grid; ++i)
    for (int j = 0; j <= grid; ++j) {
      const Vec3 du = (s.u[1] - s.u[0]) * slope_u(s, on_grid(s.u, i), on_grid(s.v, j));
      const Vec3 dv = (s.v[1] - s.v[0]) * slope_v(s, on_grid(s.u, i), on_grid(s.v, j));
      area = std::max(area, norm(cross(du, dv)));
      size = std::max({size, squared_norm(du), squared_norm(dv)});
    }
  if (!(area > 1e-12 * size)) throw Error(where + "expected a surface, found a curve or a point");
}

}  // namespace

Polynomial::Polynomial(std::vector<PolynomialSegment> segments) : segment_(std::move(segments)) {
  if (segment_.empty()) throw Error("segments: expected one or more, found none");
  for (std::size_t i = 0; i < segment_.size(); ++i) {
    const auto& s = segment_[i];
    check(s, i);
    // Taylor's formula about the middle is exact and bounds the way to any other point
    const double u = 0.5 * (s.u[0] + s.u[1]), v = 0.5 * (s.v[0] + s.v[1]);
    const double half_u = 0.5 * (s.u[1] - s.u[0]), half_v = 0.5 * (s.v[1] - s.v[0]);
    const double radius = half_u * norm(slope_u(s, u, v)) + half_v * norm(slope_v(s, u, v)) +
                          half_u * half_u * norm(s.coefficient[3]) + half_u * half_v * norm(s.coefficient[4]) +
                          half_v * half_v * norm(s.coefficient[5]);
    ball_.push_back({point_at(s, u, v), radius * (1 + 1e-12)});
  }
}

Polynomial::Foot Polynomial::nearest(Vec3 point, bool on_borders) const {
  Foot best;
  best.squared_distance = std::numeric_limits<double>::infinity();
  const auto try_segment = [&](std::size_t i, const PolynomialSegment& s) {
    for_each_start(s, point, [&](double start_u, double start_v) {
      const auto [u, v] = descend(s, point, start_u, start_v);
      const Vec3 foot = point_at(s, u, v);
      const double squared = squared_norm(foot - point);
      if (squared < best.squared_distance) best = {i, u, v, foot, squared};
    });
  };
  for (std::size_t i = 0; i < segment_.size(); ++i) {
    const double gap = norm(point - ball_[i].center) - ball_[i].radius;
    if (gap > 0 && gap * gap > best.squared_distance) continue;
    if (!on_borders) {
      try_segment(i, segment_[i]);
      continue;
    }
    for (const std::size_t end : {0U, 1U}) {
      auto side = segment_[i];
      side.u = {side.u[end], side.u[end]};
      try_segment(i, side);
      side = segment_[i];
      side.v = {side.v[end], side.v[end]};
      try_segment(i, side);
    }
  }
  return best;
}

Vec3 Polynomial::project(Vec3 point) const { return nearest(point, false).point; }

Vec3 Polynomial::project_to_seam(Vec3 point) const { return nearest(point, true).point; }

Vec3 Polynomial::normal(Vec3 point) const {
  const auto foot = nearest(point, false);
  const auto& s = segment_[foot.segment];
  // where the parameters meet in a point (a pole) the normal is that of a place a little inside
  for (double inward = 0; inward < 0.5; inward = inward == 0 ? 1e-9 : 10 * inward) {
    const double u = foot.u + inward * (0.5 * (s.u[0] + s.u[1]) - foot.u);
    const double v = foot.v + inward * (0.5 * (s.v[0] + s.v[1]) - foot.v);
    const Vec3 du = slope_u(s, u, v), dv = slope_v(s, u, v), n = cross(du, dv);
    const double length = norm(n);
    if (length > 1e-10 * (squared_norm(du) + squared_norm(dv))) return (1 / length) * n;
  }
  return {1, 0, 0};
}

double Polynomial::magnitude() const {
  double largest = 0;
  for (const auto& ball : ball_) largest = std::max(largest, largest_coordinate(ball.center) + ball.radius);
  return largest;
}

}  // namespace pamr::geometry
