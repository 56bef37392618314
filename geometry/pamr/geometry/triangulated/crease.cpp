// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/crease.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/triangulated/jet.hpp"

namespace pamr::geometry {

namespace {

constexpr double cosine_of_75_degrees = 0.25881904510252074;
constexpr double flatness = 1e-9;

Vec3 unit(Vec3 v) { return (1 / norm(v)) * v; }

class Finder {
 public:
  Finder(const Triangulation& surface, const CreaseOptions& options)
      : surface_(surface),
        options_(options),
        // rounding must not make 180 degrees an angle that a folded pair of triangles exceeds
        cosine_(options.angle < 180 ? std::cos(options.angle * std::numbers::pi / 180) : -2) {
    result_.neighbor = triangle_neighbors(surface);
  }

  Features find() {
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      const Vec3 a = point(t, 0);
      facet_.push_back(unit(cross(point(t, 1) - a, point(t, 2) - a)));
    }
    mark_given();
    mark_borders();
    find_creases();
    find_patches();
    drop_short();
    find_planes();
    find_smooth_borders();
    find_tangents();
    find_normals();
    lay_borders_on_surface();
    return std::move(result_);
  }

 private:
  Vec3 point(std::size_t t, std::size_t k) const { return surface_.points[at(surface_.triangles[t][k])]; }

  /// Both ends within 1e-6 of the surface's size from a segment: that catches what a text file rounds off.
  void mark_given() {
    is_given_.assign(surface_.triangles.size(), {false, false, false});
    if (options_.given.empty()) return;
    const double near = 1e-6 * box_of(surface_.points).diagonal();
    for (std::size_t line = 0; line < options_.given.size(); ++line)
      for (std::size_t i = 0; i + 1 < options_.given[line].size(); ++i)
        if (!mark_segment(options_.given[line][i], options_.given[line][i + 1], near))
          throw Error(
              fmt::format("creases: expected polylines along edges of the triangles, found none on segment {} of "
                          "polyline {}",
                          i + 1, line + 1));
  }

  void mark_borders() {
    is_border_.assign(surface_.triangles.size(), {false, false, false});
    if (options_.borders.empty()) return;
    std::vector<std::array<int, 2>> wanted;
    for (const auto& [a, b] : options_.borders) wanted.push_back({std::min(a, b), std::max(a, b)});
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    std::vector<char> is_found(wanted.size(), 0);
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto ends = std::minmax(surface_.triangles[t][k], surface_.triangles[t][(k + 1) % 3]);
        const std::array<int, 2> edge{ends.first, ends.second};
        const auto place = std::lower_bound(wanted.begin(), wanted.end(), edge);
        if (place == wanted.end() || *place != edge) continue;
        is_border_[t][k] = true;
        is_found[static_cast<std::size_t>(place - wanted.begin())] = 1;
      }
    for (std::size_t i = 0; i < wanted.size(); ++i)
      if (is_found[i] == 0)
        throw Error(fmt::format("border_edges: expected the two points of edges, from 0 on, found {} and {}",
                                wanted[i][0], wanted[i][1]));
  }

  bool mark_segment(Vec3 a, Vec3 b, double near) {
    const auto is_on = [&](Vec3 p) {
      const double length = squared_norm(b - a), s = length > 0 ? std::clamp(dot(p - a, b - a) / length, 0.0, 1.0) : 0;
      return norm(a + s * (b - a) - p) <= near;
    };
    std::vector<char> is_point_on;
    is_point_on.reserve(surface_.points.size());
    for (const Vec3 p : surface_.points) is_point_on.push_back(is_on(p) ? 1 : 0);
    bool found = false;
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        if (is_point_on[at(surface_.triangles[t][k])] != 0 && is_point_on[at(surface_.triangles[t][(k + 1) % 3])] != 0)
          found = is_given_[t][k] = true;
    return found;
  }

  /// Takes out short creases with the same piece on both sides.
  void drop_short() {
    if (!(options_.shortest > 0)) return;
    const auto n = result_.creases.size();
    std::vector<char> is_inner(n, 0);
    for (std::size_t t = 0; t < facet_.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const int crease = result_.crease_at[t][k], other = result_.neighbor[t][k].triangle;
        if (crease >= 0 && other >= 0 && result_.patch[t] == result_.patch[at(other)]) is_inner[at(crease)] = 1;
      }
    std::vector<std::vector<int>> at_point(surface_.points.size());
    for (std::size_t c = 0; c < n; ++c)
      if (is_inner[c] != 0)
        for (const int p : result_.creases[c].point) at_point[at(p)].push_back(static_cast<int>(c));
    std::vector<char> is_seen(n, 0), is_dropped(n, 0);
    for (std::size_t start = 0; start < n; ++start) {
      if (is_inner[start] == 0 || is_seen[start] != 0) continue;
      std::vector<int> together{static_cast<int>(start)};
      is_seen[start] = 1;
      double length = 0;
      for (std::size_t i = 0; i < together.size(); ++i) {
        const auto& ends = result_.creases[at(together[i])].point;
        length += norm(surface_.points[at(ends[1])] - surface_.points[at(ends[0])]);
        for (const int p : ends)
          for (const int next : at_point[at(p)])
            if (is_seen[at(next)] == 0) {
              is_seen[at(next)] = 1;
              together.push_back(next);
            }
      }
      for (const int c : together) is_dropped[at(c)] = length < options_.shortest ? 1 : 0;
    }
    std::vector<int> new_number(n, -1);
    int n_kept = 0;
    for (std::size_t c = 0; c < n; ++c) {
      if (is_dropped[c] != 0) continue;
      result_.creases[at(n_kept)] = result_.creases[c];
      new_number[c] = n_kept++;
    }
    result_.creases.resize(at(n_kept));
    for (auto& creases : result_.crease_at)
      for (int& crease : creases)
        if (crease >= 0) crease = new_number[at(crease)];
  }

  /// Whether the surface ends at an edge, or is not smooth there.
  bool is_sharp(std::size_t t, std::size_t k) const {
    const int other = result_.neighbor[t][k].triangle;
    return other < 0 || dot(facet_[t], facet_[at(other)]) < cosine_ || is_given_[t][k];
  }

  void find_creases() {
    const auto n = surface_.triangles.size();
    result_.crease_at.assign(n, {-1, -1, -1});
    for (std::size_t t = 0; t < n; ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [other, edge] = result_.neighbor[t][k];
        if (!(is_sharp(t, k) || is_border_[t][k]) || (other >= 0 && at(other) < t)) continue;
        const auto number = static_cast<int>(result_.creases.size());
        result_.creases.push_back({{surface_.triangles[t][k], surface_.triangles[t][(k + 1) % 3]}, {}});
        result_.crease_at[t][k] = number;
        if (other >= 0) result_.crease_at[at(other)][at(edge)] = number;
      }
  }

  void find_patches() {
    result_.patch.assign(surface_.triangles.size(), -1);
    int n_patches = 0;
    std::vector<std::size_t> waiting;
    for (std::size_t start = 0; start < result_.patch.size(); ++start) {
      if (result_.patch[start] >= 0) continue;
      result_.patch[start] = n_patches;
      waiting.push_back(start);
      while (!waiting.empty()) {
        const auto t = waiting.back();
        waiting.pop_back();
        for (std::size_t k = 0; k < 3; ++k) {
          const int next = result_.neighbor[t][k].triangle;
          if (result_.crease_at[t][k] >= 0 || result_.patch[at(next)] >= 0) continue;
          result_.patch[at(next)] = n_patches;
          waiting.push_back(at(next));
        }
      }
      ++n_patches;
    }
    result_.is_planar.assign(at(n_patches), 1);
    result_.plane_normal.resize(at(n_patches));
    result_.plane_point.resize(at(n_patches));
  }

  void find_planes() {
    std::vector<double> largest(result_.is_planar.size(), 0), size(largest);
    for (std::size_t t = 0; t < facet_.size(); ++t) {
      const auto p = at(result_.patch[t]);
      const double area = norm(cross(point(t, 1) - point(t, 0), point(t, 2) - point(t, 0)));
      if (!(area > largest[p])) continue;
      largest[p] = area;
      result_.plane_normal[p] = facet_[t];
      result_.plane_point[p] = point(t, 0);
    }
    for (int pass = 0; pass < 2; ++pass)  // the size of each patch, then its flatness
      for (std::size_t t = 0; t < facet_.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
          const auto p = at(result_.patch[t]);
          const Vec3 d = point(t, k) - result_.plane_point[p];
          if (pass == 0)
            size[p] = std::max(size[p], norm(d));
          else if (std::abs(dot(d, result_.plane_normal[p])) > flatness * size[p])
            result_.is_planar[p] = 0;
        }
  }

  void find_smooth_borders() {
    is_smooth_.assign(result_.creases.size(), 0);
    for (std::size_t t = 0; t < facet_.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const int crease = result_.crease_at[t][k], other = result_.neighbor[t][k].triangle;
        if (crease < 0 || is_sharp(t, k)) continue;
        const bool is_flat =
            result_.is_planar[at(result_.patch[t])] != 0 || result_.is_planar[at(result_.patch[at(other)])] != 0;
        is_smooth_[at(crease)] = is_flat ? 0 : 1;
      }
  }
  /// Whether normals on the two sides of an edge have nothing to do with each other.
  bool is_barrier(int t, std::size_t k) const {
    const int crease = result_.crease_at[at(t)][k];
    return crease >= 0 && is_smooth_[at(crease)] == 0;
  }

  void find_tangents() {
    std::vector<std::array<int, 2>> at_point(surface_.points.size(), {-1, -1});
    std::vector<int> n_at(surface_.points.size(), 0);
    for (std::size_t c = 0; c < result_.creases.size(); ++c)
      for (const int p : result_.creases[c].point) {
        if (n_at[at(p)] < 2) at_point[at(p)][at(n_at[at(p)])] = static_cast<int>(c);
        ++n_at[at(p)];
      }
    const auto far_end = [&](int crease, int p) {
      const auto& ends = result_.creases[at(crease)].point;
      return surface_.points[at(ends[0] == p ? ends[1] : ends[0])];
    };
    for (auto& crease : result_.creases) {
      const Vec3 along = unit(surface_.points[at(crease.point[1])] - surface_.points[at(crease.point[0])]);
      std::array<bool, 2> is_smooth{};
      for (std::size_t end = 0; end < 2; ++end) {
        crease.tangent[end] = along;
        const int p = crease.point[end];
        if (n_at[at(p)] != 2) continue;
        const Vec3 here = surface_.points[at(p)];
        const Vec3 in = here - far_end(at_point[at(p)][0], p), out = far_end(at_point[at(p)][1], p) - here;
        if (dot(unit(in), unit(out)) < cosine_of_75_degrees) continue;
        const Vec3 tangent = unit(norm(out) * unit(in) + norm(in) * unit(out));  // of the circle through three points
        crease.tangent[end] = dot(tangent, along) < 0 ? -tangent : tangent;
        is_smooth[end] = true;
      }
      // Beside a corner the arc that leaves the smooth end goes on.
      for (std::size_t end = 0; end < 2; ++end)
        if (!is_smooth[end] && is_smooth[1 - end])
          crease.tangent[end] = 2 * dot(crease.tangent[1 - end], along) * along - crease.tangent[1 - end];
    }
  }

  /// Turns the tangents of smooth borders into the tangent planes of the surface.
  void lay_borders_on_surface() {
    constexpr double min_length = 0.5;  // shorter ones come from a normal that nearly follows the border
    for (std::size_t t = 0; t < facet_.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const int number = result_.crease_at[t][k];
        if (number < 0 || is_smooth_[at(number)] == 0) continue;
        auto& crease = result_.creases[at(number)];
        if (crease.point[0] != surface_.triangles[t][k]) continue;  // once, from the side that it runs along
        for (std::size_t end = 0; end < 2; ++end) {
          const Vec3 normal = result_.normal[t][(k + end) % 3];
          const Vec3 along = crease.tangent[end] - dot(crease.tangent[end], normal) * normal;
          if (norm(along) > min_length) crease.tangent[end] = unit(along);
        }
      }
  }

  /// The triangles around corner k of t that no crease parts from t, with the corner that the point is of each.
  struct Sector {
    std::vector<std::array<int, 2>> members;
  };
  Sector sector(int t, int k) const {
    Sector result{{{t, k}}};
    for (int a = t, b = k;;) {
      if (is_barrier(a, at(b))) break;
      const auto [next, edge] = result_.neighbor[at(a)][at(b)];
      a = next;
      b = (edge + 1) % 3;
      if (a == t) return result;
      result.members.push_back({a, b});
    }
    for (int a = t, b = k;;) {
      const auto before = at((b + 2) % 3);
      if (is_barrier(a, before)) break;
      const auto [next, edge] = result_.neighbor[at(a)][before];
      a = next;
      b = edge;
      result.members.push_back({a, b});
    }
    return result;
  }

  void find_normals() {
    result_.normal.assign(facet_.size(), {});
    std::vector<std::array<bool, 3>> done(facet_.size(), {false, false, false});
    for (int t = 0; at(t) < facet_.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        if (done[at(t)][at(k)]) continue;
        const auto around = sector(t, k);
        const Vec3 normal = normal_at(point(at(t), at(k)), around, at(result_.patch[at(t)]));
        for (const auto [triangle, corner] : around.members) {
          result_.normal[at(triangle)][at(corner)] = normal;
          done[at(triangle)][at(corner)] = true;
        }
      }
  }

  /// Facets count by the sine of their angle over the product of their two sides: exact for points of a sphere
  /// (N. Max, Weights for computing vertex normals from facet normals, 1999). Then the quadric is fitted, twice.
  Vec3 normal_at(Vec3 origin, const Sector& around, std::size_t patch) const {
    if (result_.is_planar[patch] != 0) return result_.plane_normal[patch];
    Vec3 sum;
    std::vector<int> triangles;
    for (const auto [t, k] : around.members) {
      const Vec3 a = point(at(t), at((k + 1) % 3)) - origin, b = point(at(t), at((k + 2) % 3)) - origin;
      sum = sum + (1 / (squared_norm(a) * squared_norm(b))) * cross(a, b);
      triangles.push_back(t);
    }
    if (!(norm(sum) > 0)) return facet_[at(around.members.front()[0])];
    Vec3 normal = unit(sum);
    for (std::size_t ring = 0, from = 0; ring < 2; ++ring)
      for (const auto end = triangles.size(); from < end; ++from)
        for (std::size_t k = 0; k < 3; ++k) {
          const auto t = at(triangles[from]);
          const int next = result_.neighbor[t][k].triangle;
          if (!is_barrier(triangles[from], k) && std::find(triangles.begin(), triangles.end(), next) == triangles.end())
            triangles.push_back(next);
        }
    std::vector<int> numbers;
    for (const int t : triangles)
      numbers.insert(numbers.end(), surface_.triangles[at(t)].begin(), surface_.triangles[at(t)].end());
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    std::vector<Vec3> points;
    for (const int p : numbers)
      if (surface_.points[at(p)] != origin) points.push_back(surface_.points[at(p)]);
    const Vec3 first = normal;
    for (int pass = 0; pass < 2; ++pass) normal = jet_normal(origin, normal, points);
    // A fit that leaves the side of a facet is none.
    for (const auto [t, k] : around.members)
      if (!(dot(normal, facet_[at(t)]) > cosine_of_75_degrees)) return first;
    return normal;
  }

  const Triangulation& surface_;
  const CreaseOptions& options_;
  double cosine_;
  std::vector<std::array<bool, 3>> is_given_, is_border_;
  std::vector<char> is_smooth_;  // by crease
  std::vector<Vec3> facet_;
  Features result_;
};

}  // namespace

Features find_features(const Triangulation& surface, const CreaseOptions& options) {
  return Finder(surface, options).find();
}

std::vector<std::array<int, 2>> borders_of(const Triangulation& surface, const std::vector<int>& part) {
  std::vector<std::array<int, 2>> result;
  const auto neighbor = triangle_neighbors(surface);
  for (std::size_t t = 0; t < neighbor.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const int other = neighbor[t][k].triangle;
      if (other < 0 || at(other) < t || part[t] == part[at(other)]) continue;
      const auto ends = std::minmax(surface.triangles[t][k], surface.triangles[t][(k + 1) % 3]);
      result.push_back({ends.first, ends.second});
    }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace pamr::geometry
