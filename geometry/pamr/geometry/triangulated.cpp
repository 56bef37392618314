// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "pamr/base/error.hpp"
#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

namespace {

constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }
constexpr double border = 1e-12;    // parameters this near to the border of a triangle lie on it
constexpr double gain = 1 - 1e-12;  // a squared distance must fall below this part to count as nearer
constexpr double rounding = 1e-14;  // of the largest coordinate
constexpr int walk_limit = 100;

/// Parameters of the point s of the way from corner k to corner k + 1.
std::array<double, 2> on_edge(int k, double s) {
  if (k == 0) return {s, 0};
  return k == 1 ? std::array{1 - s, s} : std::array{0.0, 1 - s};
}

/// Inner points of the curve between two points of a smooth piece with normals there.
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

}  // namespace

Triangulated::Triangulated(const Triangulation& surface, const Options& options) {
  require_valid(surface, "triangulated surface", options.open_allowed);
  if (!(options.feature_angle > 0 && options.feature_angle < 180))
    throw Error("feature_angle: expected degrees between 0 and 180, found " + decimal(options.feature_angle));
  for (const Vec3 p : surface.points) magnitude_ = std::max(magnitude_, largest_coordinate(p));
  features_ = find_features(surface, options.feature_angle);
  build_triangles(surface);
  int only_patch = -1;
  for (int pass = 0; pass < (options.near ? 2 : 1); ++pass) {
    if (pass == 1) only_patch = features_.patch[at(nearest(checked_point(*options.near, "near")).triangle)];
    triangle_of_tree_.clear();
    std::vector<std::array<Vec3, 3>> flat;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      if (only_patch >= 0 && features_.patch[t] != only_patch) continue;
      const auto& corner = surface.triangles[t];
      flat.push_back({surface.points[at(corner[0])], surface.points[at(corner[1])], surface.points[at(corner[2])]});
      triangle_of_tree_.push_back(static_cast<int>(t));
    }
    tree_.emplace(flat);
  }
  stays_in_patch_ = only_patch >= 0;
  is_flat_ = stays_in_patch_ && features_.is_planar[at(only_patch)] != 0;
  build_edges(surface, only_patch);
}

void Triangulated::build_triangles(const Triangulation& surface) {
  const auto n = surface.triangles.size();
  std::vector<std::array<std::array<Vec3, 2>, 3>> inner(n);
  curved_.reserve(n);
  for (std::size_t t = 0; t < n; ++t) {
    const auto& corner = surface.triangles[t];
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = surface.points[at(corner[k])];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto next = (k + 1) % 3;
      const auto [other, edge] = features_.neighbour[t][k];
      if (other >= 0 && at(other) < t) {  // the same bits from both sides
        inner[t][k] = {inner[at(other)][at(edge)][1], inner[at(other)][at(edge)][0]};
        continue;
      }
      const int number = features_.crease_at[t][k];
      if (number >= 0) {
        const auto& crease = features_.creases[at(number)];  // made from this triangle, so it runs the same way
        inner[t][k] = {inner_point(p[k], p[next], crease.tangent[0]), inner_point(p[next], p[k], -crease.tangent[1])};
      } else if (features_.is_planar[at(features_.patch[t])] != 0) {
        inner[t][k] = {p[k] + (1.0 / 3) * (p[next] - p[k]), p[next] + (1.0 / 3) * (p[k] - p[next])};
      } else {
        inner[t][k] = smooth_edge(p[k], p[next], features_.normal[t][k], features_.normal[t][next]);
      }
    }
    curved_.emplace_back(p, inner[t]);
  }
}

void Triangulated::build_edges(const Triangulation& surface, int only_patch) {
  std::vector<bool> is_wanted(features_.creases.size(), only_patch < 0);
  for (std::size_t t = 0; t < features_.patch.size(); ++t)
    for (const int crease : features_.crease_at[t])
      if (crease >= 0 && features_.patch[t] == only_patch) is_wanted[at(crease)] = true;
  std::map<int, int> number_of_point;
  std::vector<std::array<Vec3, 3>> flat;
  for (std::size_t c = 0; c < features_.creases.size(); ++c) {
    if (!is_wanted[c]) continue;
    const auto& crease = features_.creases[c];
    const Vec3 a = surface.points[at(crease.point[0])], b = surface.points[at(crease.point[1])];
    auto& ends = edge_ends_.emplace_back();
    for (std::size_t end = 0; end < 2; ++end) {
      const auto next = static_cast<int>(number_of_point.size());
      ends[end] = number_of_point.emplace(crease.point[end], next).first->second;
      edges_at_end_.resize(number_of_point.size());
      edges_at_end_[at(ends[end])].push_back(static_cast<int>(edges_.size()));
    }
    edges_.emplace_back(std::array{a, inner_point(a, b, crease.tangent[0]), inner_point(b, a, -crease.tangent[1]), b});
    flat.push_back({a, b, b});
  }
  if (!flat.empty()) edge_tree_.emplace(flat);
}

bool Triangulated::try_triangle(Vec3 point, int triangle, double u, double v, Place& best) const {
  const Foot foot = curved_[at(triangle)].nearest(point, u, v);
  if (!(foot.squared_distance < gain * best.foot.squared_distance)) return false;
  best = {foot, triangle};
  return true;
}

bool Triangulated::go_on(Vec3 point, Place& here) const {
  const auto [foot, triangle] = here;
  const std::array<double, 3> far{foot.v, 1 - foot.u - foot.v, foot.u};  // from edges 0, 1 and 2
  const auto may_cross = [&](int t, int k) {
    return features_.neighbour[at(t)][at(k)].triangle >= 0 &&
           !(stays_in_patch_ && features_.crease_at[at(t)][at(k)] >= 0);
  };
  for (int k = 0; k < 3; ++k) {
    if (!(far[at(k)] <= border)) continue;
    const int before = (k + 2) % 3;
    if (far[at(before)] <= border) {  // corner k: all the triangles around it, out and back
      Place best = here;
      int t = triangle, c = k;
      while (may_cross(t, c)) {
        const auto [next, edge] = features_.neighbour[at(t)][at(c)];
        t = next;
        c = (edge + 1) % 3;
        if (t == triangle) break;
        const auto [u, v] = on_edge(c, 0);
        try_triangle(point, t, u, v, best);
      }
      if (t != triangle || !may_cross(t, k))
        for (t = triangle, c = k; may_cross(t, (c + 2) % 3);) {
          const auto [next, edge] = features_.neighbour[at(t)][at((c + 2) % 3)];
          t = next;
          c = edge;
          if (t == triangle) break;
          const auto [u, v] = on_edge(c, 0);
          try_triangle(point, t, u, v, best);
        }
      if (best.triangle == triangle) return false;
      here = best;
      return true;
    }
    if (far[at((k + 1) % 3)] <= border || !may_cross(triangle, k)) continue;  // corner k + 1 has its own turn
    const auto [next, edge] = features_.neighbour[at(triangle)][at(k)];
    const double s = k == 0 ? foot.u : (k == 1 ? foot.v : 1 - foot.v);
    const auto [u, v] = on_edge(edge, 1 - s);
    if (try_triangle(point, next, u, v, here)) return true;
  }
  return false;
}

Triangulated::Place Triangulated::nearest(Vec3 point) const {
  const auto hit = tree_->nearest(point);
  const int triangle = triangle_of_tree_[at(hit.triangle)];
  Place here{curved_[at(triangle)].nearest(point, hit.u, hit.v), triangle};
  for (int i = 0; i < walk_limit && go_on(point, here); ++i) {
  }
  return here;
}

Vec3 Triangulated::onto_plane(int triangle, Vec3 point) const {
  const auto patch = at(features_.patch[at(triangle)]);
  if (features_.is_planar[patch] == 0) return point;
  const Vec3 normal = features_.plane_normal[patch];
  return point - dot(point - features_.plane_point[patch], normal) * normal;
}

Vec3 Triangulated::project(Vec3 point) const {
  const auto here = nearest(point);
  const Vec3 foot = onto_plane(here.triangle, here.foot.point);
  // Inside a planar piece only the distance from its plane changes; the way over parameters would round.
  const auto patch = at(features_.patch[at(here.triangle)]);
  if (features_.is_planar[patch] == 0) return foot;
  const Vec3 direct = onto_plane(here.triangle, point);
  return squared_norm(direct - foot) <= squared_norm(rounding * Vec3{magnitude_, 0, 0}) ? direct : foot;
}

Vec3 Triangulated::normal(Vec3 point) const {
  const auto here = nearest(point);
  const auto patch = at(features_.patch[at(here.triangle)]);
  if (features_.is_planar[patch] != 0) return features_.plane_normal[patch];
  const Vec3 normal = curved_[at(here.triangle)].normal(here.foot.u, here.foot.v);
  const double length = norm(normal);
  return length > least_length ? (1 / length) * normal : features_.normal[at(here.triangle)][0];
}

Vec3 Triangulated::project_to_seam(Vec3 point) const {
  if (!edge_tree_) return project(point);
  const auto hit = edge_tree_->nearest(point);
  Foot best = edges_[at(hit.triangle)].nearest(point, std::clamp(hit.u + hit.v, 0.0, 1.0));
  for (const int end : edge_ends_[at(hit.triangle)])
    for (const int other : edges_at_end_[at(end)]) {
      if (other == hit.triangle) continue;
      const Foot foot = edges_[at(other)].nearest(point, edge_ends_[at(other)][0] == end ? 0 : 1);
      if (foot.squared_distance < gain * best.squared_distance) best = foot;
    }
  return best.point;
}

}  // namespace pamr::geometry
