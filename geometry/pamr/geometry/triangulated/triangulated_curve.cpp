// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/triangulated_curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pamr::geometry {

namespace {

constexpr int iteration_limit = 20;
constexpr double newton_tolerance = 1e-9, descent_tolerance = 1e-14;

struct Pair {
  double u = 0, v = 0;
};

/// g . d + d . H d / 2
struct Model {
  Pair g;
  double uu = 0, uv = 0, vv = 0;

  double operator()(Pair d) const {
    return g.u * d.u + g.v * d.v + 0.5 * (uu * d.u * d.u + 2 * uv * d.u * d.v + vv * d.v * d.v);
  }

  /// Where in the triangle it is least; `at` is where it was set up, H is positive definite.
  Pair least(Pair at) const {
    const double det = uu * vv - uv * uv;
    const Pair free{at.u + (uv * g.v - vv * g.u) / det, at.v + (uv * g.u - uu * g.v) / det};
    if (free.u >= 0 && free.v >= 0 && free.u + free.v <= 1) return free;
    constexpr std::array<Pair, 3> start{{{0, 0}, {1, 0}, {0, 1}}}, along{{{1, 0}, {-1, 1}, {0, -1}}};
    Pair best = at;
    double value = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      const Pair from{start[k].u - at.u, start[k].v - at.v}, d = along[k];
      const double slope =
          g.u * d.u + g.v * d.v + uu * from.u * d.u + uv * (from.u * d.v + from.v * d.u) + vv * from.v * d.v;
      const double curvature = uu * d.u * d.u + 2 * uv * d.u * d.v + vv * d.v * d.v;
      const double s = std::clamp(-slope / curvature, 0.0, 1.0);
      const double here = (*this)({from.u + s * d.u, from.v + s * d.v});
      if (here < value) {
        value = here;
        best = {start[k].u + s * d.u, start[k].v + s * d.v};
      }
    }
    return best;
  }
};

}  // namespace

Vec3 inner_point(Vec3 from, Vec3 to, Vec3 tangent) {
  const Vec3 chord = to - from;
  const double length = norm(chord), cosine = dot(tangent, chord) / length;
  return from + (2 * length / (3 * (1 + std::max(cosine, 0.0)))) * tangent;
}

CurvedEdge::CurvedEdge(const std::array<Vec3, 4>& p)
    : coefficient_{p[0], 3 * (p[1] - p[0]), 3 * (p[2] - 2 * p[1] + p[0]), p[3] - 3 * p[2] + 3 * p[1] - p[0]} {}

Vec3 CurvedEdge::point(double u) const {
  const auto& c = coefficient_;
  return c[0] + u * (c[1] + u * (c[2] + u * c[3]));
}

Foot CurvedEdge::nearest(Vec3 to, double u) const {
  const auto& c = coefficient_;
  const Vec3 start = point(u);
  Foot best{start, squared_norm(start - to), u, 0};
  for (int i = 0; i < iteration_limit; ++i) {
    const Vec3 r = point(u) - to, first = c[1] + u * (2 * c[2] + 3 * u * c[3]), second = 2 * c[2] + 6 * u * c[3];
    const double descent = squared_norm(first), full = descent + dot(r, second);
    if (!(descent > 0)) break;
    const bool is_newton = full > 0.1 * descent;
    const double next = std::clamp(u - dot(r, first) / (is_newton ? full : descent), 0.0, 1.0);
    const double step = std::abs(next - u);
    u = next;
    const Vec3 p = point(u);
    const double distance = squared_norm(p - to);
    if (distance < best.squared_distance) best = {p, distance, u, 0};
    if (step < (is_newton ? newton_tolerance : descent_tolerance)) break;
  }
  return best;
}

CurvedTriangle::CurvedTriangle(const std::array<Vec3, 3>& corner, const std::array<std::array<Vec3, 2>, 3>& edge) {
  const Vec3 a = corner[0], b = corner[1], c = corner[2];
  const Vec3 p210 = edge[0][0], p120 = edge[0][1], p021 = edge[1][0], p012 = edge[1][1], p102 = edge[2][0],
             p201 = edge[2][1];
  const Vec3 edges = (1.0 / 6) * (p210 + p120 + p021 + p012 + p102 + p201), corners = (1.0 / 3) * (a + b + c);
  const Vec3 p111 = edges + 0.5 * (edges - corners);
  coefficient_ = {a,
                  3 * (p210 - a),
                  3 * (p201 - a),
                  3 * (p120 - 2 * p210 + a),
                  6 * (p111 - p210 - p201 + a),
                  3 * (p102 - 2 * p201 + a),
                  b - 3 * p120 + 3 * p210 - a,
                  3 * (p021 - 2 * p111 + p201 - p120 + 2 * p210 - a),
                  3 * (p012 - 2 * p111 + p210 - p102 + 2 * p201 - a),
                  c - 3 * p102 + 3 * p201 - a};
  double bend = 0, size = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 from = corner[k], chord = corner[(k + 1) % 3] - from;
    bend = std::max({bend, norm(edge[k][0] - from - (1.0 / 3) * chord), norm(edge[k][1] - from - (2.0 / 3) * chord)});
    size = std::max(size, norm(chord));
  }
  is_flat_ = bend <= 1e-13 * size;
  if (is_flat_) coefficient_ = {a, b - a, c - a};
}

Vec3 CurvedTriangle::point(double u, double v) const {
  const auto& c = coefficient_;
  return c[0] + u * (c[1] + u * (c[3] + u * c[6] + v * c[7]) + v * c[4]) +
         v * (c[2] + v * (c[5] + v * c[9] + u * c[8]));
}

Vec3 CurvedTriangle::normal(double u, double v) const {
  const auto& c = coefficient_;
  const Vec3 du = c[1] + 2 * u * c[3] + v * c[4] + 3 * u * u * c[6] + 2 * u * v * c[7] + v * v * c[8];
  const Vec3 dv = c[2] + 2 * v * c[5] + u * c[4] + 3 * v * v * c[9] + 2 * u * v * c[8] + u * u * c[7];
  return cross(du, dv);
}

Foot CurvedTriangle::nearest(Vec3 to, double u, double v) const {
  const auto& c = coefficient_;
  const Vec3 start = point(u, v);
  Foot best{start, squared_norm(start - to), u, v};
  if (is_flat_) {  // the model is exact
    const Vec3 r = start - to;
    const Model model{{dot(r, c[1]), dot(r, c[2])}, dot(c[1], c[1]), dot(c[1], c[2]), dot(c[2], c[2])};
    const Pair least = model.least({u, v});
    const Vec3 p = point(least.u, least.v);
    if (squared_norm(p - to) < best.squared_distance) best = {p, squared_norm(p - to), least.u, least.v};
    return best;
  }
  for (int i = 0; i < iteration_limit; ++i) {
    const Vec3 r = point(u, v) - to;
    const Vec3 du = c[1] + 2 * u * c[3] + v * c[4] + 3 * u * u * c[6] + 2 * u * v * c[7] + v * v * c[8];
    const Vec3 dv = c[2] + 2 * v * c[5] + u * c[4] + 3 * v * v * c[9] + 2 * u * v * c[8] + u * u * c[7];
    const Vec3 duu = 2 * c[3] + 6 * u * c[6] + 2 * v * c[7], duv = c[4] + 2 * u * c[7] + 2 * v * c[8],
               dvv = 2 * c[5] + 6 * v * c[9] + 2 * u * c[8];
    Model model{{dot(r, du), dot(r, dv)}, dot(du, du), dot(du, dv), dot(dv, dv)};
    const double det = model.uu * model.vv - model.uv * model.uv;
    if (!(det > 0)) break;
    Model full = model;
    full.uu += dot(r, duu);
    full.uv += dot(r, duv);
    full.vv += dot(r, dvv);
    const bool is_newton = full.uu > 0.1 * model.uu && full.uu * full.vv - full.uv * full.uv > 0.01 * det;
    const Pair next = (is_newton ? full : model).least({u, v});
    const double step = std::max(std::abs(next.u - u), std::abs(next.v - v));
    u = next.u;
    v = next.v;
    const Vec3 p = point(u, v);
    const double distance = squared_norm(p - to);
    if (distance < best.squared_distance) best = {p, distance, u, v};
    if (step < (is_newton ? newton_tolerance : descent_tolerance)) break;
  }
  return best;
}

std::array<Vec3, 2> smooth_edge(Vec3 a, Vec3 b, Vec3 normal_a, Vec3 normal_b) {
  const auto leave = [](Vec3 from, Vec3 to, Vec3 normal) {
    const Vec3 chord = to - from, along = chord - dot(chord, normal) * normal;
    const double length = norm(along);
    // A normal that nearly follows the chord says nothing about the curve.
    if (!(length > 0.5 * norm(chord))) return from + (1.0 / 3) * chord;
    return inner_point(from, to, (1 / length) * along);
  };
  return {leave(a, b, normal_a), leave(b, a, normal_b)};
}

}  // namespace pamr::geometry
