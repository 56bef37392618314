// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/describe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/geometry/triangulated/crease.hpp"
#include "pamr/geometry/triangulated/edge_table.hpp"
#include "pamr/geometry/triangulated/groups.hpp"
#include "pamr/geometry/triangulated/self_intersection.hpp"
#include "pamr/geometry/triangulated/shells.hpp"
#include "pamr/geometry/triangulated/triangulated_curve.hpp"
#include "surface_mesh/triangle_shape.hpp"

namespace pamr::surface_mesh {

namespace {

using geometry::Triangulation;
using geometry::Vec3;

void note(Found& found, Vec3 where) {
  if (found.count++ == 0) found.where = where;
}

class Describer {
 public:
  Describer(const Triangulation& surface, const DescribeOptions& options) : surface_(surface), options_(options) {}

  Description describe() {
    result_.n_points = std::ssize(surface_.points);
    result_.n_triangles = std::ssize(surface_.triangles);
    look_at_points();
    look_at_triangles();
    look_for_duplicates();
    look_at_edges();
    if (options_.find_deviation && result_.is_surface()) find_deviation();
    return std::move(result_);
  }

 private:
  Vec3 point(int n) const { return surface_.points[at(n)]; }
  std::array<Vec3, 3> corners(std::size_t t) const {
    const auto& [a, b, c] = surface_.triangles[t];
    return {point(a), point(b), point(c)};
  }
  static bool has_point_twice(const std::array<int, 3>& n) { return n[0] == n[1] || n[1] == n[2] || n[2] == n[0]; }

  void look_at_points() {
    std::vector<char> is_used(surface_.points.size(), 0);
    for (const auto& corner : surface_.triangles)
      for (const int n : corner) is_used[at(n)] = 1;
    std::vector<int> order;
    geometry::Box box;
    for (int n = 0; n < std::ssize(surface_.points); ++n) {
      const Vec3 p = point(n);
      if (is_used[at(n)] == 0) {
        note(result_.unused_points, p);
        continue;
      }
      order.push_back(n);
      box.extend(p);
    }
    if (order.empty()) return;
    result_.box = box;
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      return point(a) == point(b) ? a < b : geometry::lexicographically_less(point(a), point(b));
    });
    int first = -1;
    for (std::size_t i = 1; i < order.size(); ++i) {
      if (!(point(order[i]) == point(order[i - 1]))) continue;
      ++result_.coincident_points.count;
      if (first < 0 || order[i] < first) first = order[i];
    }
    if (first >= 0) result_.coincident_points.where = point(first);
  }

  void look_at_triangles() {
    double min_angle = std::numbers::pi;
    const Vec3 origin = result_.box.center();  // near the body: sums lose less
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      const auto p = corners(t);
      const Vec3 twice = cross(p[1] - p[0], p[2] - p[0]);
      result_.area += 0.5 * norm(twice);
      result_.volume += dot(p[0] - origin, twice) / 6;
      if (has_point_twice(surface_.triangles[t]) || is_flat(p)) {
        note(result_.flat_triangles, p[0]);
        min_angle = 0;
        result_.min_angle_where = p[0];
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 a = p[(k + 1) % 3] - p[k], b = p[(k + 2) % 3] - p[k];
        const double angle = std::atan2(norm(cross(a, b)), dot(a, b));
        if (angle < min_angle) {
          min_angle = angle;
          result_.min_angle_where = p[k];
        }
      }
    }
    if (!surface_.triangles.empty()) result_.min_angle = min_angle * 180 / std::numbers::pi;
  }

  void look_for_duplicates() {
    std::vector<std::array<int, 4>> rows;  // sorted corners, triangle
    rows.reserve(surface_.triangles.size());
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      auto n = surface_.triangles[t];
      std::sort(n.begin(), n.end());
      rows.push_back({n[0], n[1], n[2], static_cast<int>(t)});
    }
    std::sort(rows.begin(), rows.end());
    int first = -1;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      if (!std::equal(rows[i].begin(), rows[i].begin() + 3, rows[i - 1].begin())) continue;
      ++result_.duplicate_triangles.count;
      if (first < 0 || rows[i][3] < first) first = rows[i][3];
    }
    if (first >= 0) result_.duplicate_triangles.where = corners(at(first))[0];
  }

  void look_at_edges() {
    auto whole = surface_;  // without what has no three edges
    std::erase_if(whole.triangles, [](const auto& n) { return has_point_twice(n); });
    if (whole.triangles.empty()) return;
    const geometry::EdgeTable edges(whole);
    const auto n = whole.triangles.size();
    geometry::Groups fans(3 * n);
    const auto corner = [](const geometry::Side& side, bool at_low) {
      return 3 * side.triangle + (side.upwards == at_low ? side.edge : (side.edge + 1) % 3);
    };
    std::vector<geometry::Side> open;
    double sum = 0, least = std::numeric_limits<double>::infinity(), longest = 0;
    std::int64_t n_edges = 0;
    const double cosine = std::cos(options_.feature_angle * std::numbers::pi / 180);
    edges.for_each_edge([&](std::span<const geometry::Side> sides) {
      const Vec3 a = point(sides[0].low), b = point(sides[0].high);
      const double length = norm(b - a);
      sum += length;
      least = std::min(least, length);
      longest = std::max(longest, length);
      ++n_edges;
      for (std::size_t i = 1; i < sides.size(); ++i) {
        fans.join(corner(sides[0], true), corner(sides[i], true));
        fans.join(corner(sides[0], false), corner(sides[i], false));
      }
      if (sides.size() == 1) open.push_back(sides[0]);
      if (sides.size() == 1) note(result_.open_edges, a);
      if (sides.size() > 2) note(result_.non_manifold_edges, a);
      if (sides.size() != 2) return;
      const bool is_turned = sides[0].upwards == sides[1].upwards;
      if (is_turned) note(result_.turned_edges, a);
      const Vec3 one = normal_of(whole, sides[0].triangle), other = normal_of(whole, sides[1].triangle);
      if ((is_turned ? -1 : 1) * dot(one, other) < cosine * norm(one) * norm(other)) ++result_.sharp_edges;
    });
    result_.min_edge = least;
    result_.max_edge = longest;
    result_.mean_edge = sum / static_cast<double>(n_edges);
    count_fans(whole, fans);
    join_loops(whole, open, fans);
    list_shells(whole);
  }

  Vec3 normal_of(const Triangulation& whole, int t) const {
    const auto& [a, b, c] = whole.triangles[at(t)];
    return cross(point(b) - point(a), point(c) - point(a));
  }

  void count_fans(const Triangulation& whole, geometry::Groups& fans) {
    std::vector<int> fan_of(surface_.points.size(), -1);
    std::vector<char> is_counted(surface_.points.size(), 0);
    for (int c = 0; c < std::ssize(whole.triangles) * 3; ++c) {
      const int n = whole.triangles[at(c / 3)][at(c % 3)], fan = fans.of(c);
      if (fan_of[at(n)] < 0) fan_of[at(n)] = fan;
      if (fan_of[at(n)] == fan || is_counted[at(n)] != 0) continue;
      is_counted[at(n)] = 1;
      note(result_.non_manifold_points, point(n));
    }
  }

  /// Open edges hang together where they meet in one fan of triangles: two holes that touch in a point are two.
  void join_loops(const Triangulation& whole, const std::vector<geometry::Side>& open, geometry::Groups& fans) {
    std::vector<std::array<int, 2>> ends;
    std::vector<int> used;
    for (const auto& side : open) {
      ends.push_back({fans.of(3 * side.triangle + side.edge), fans.of(3 * side.triangle + (side.edge + 1) % 3)});
      used.insert(used.end(), ends.back().begin(), ends.back().end());
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const auto index = [&](int fan) {
      return static_cast<int>(std::lower_bound(used.begin(), used.end(), fan) - used.begin());
    };
    geometry::Groups together(used.size());
    for (const auto& [a, b] : ends) together.join(index(a), index(b));
    std::vector<int> loop_of(used.size(), -1);
    std::vector<geometry::Box> boxes;
    for (std::size_t i = 0; i < open.size(); ++i) {
      auto& number = loop_of[at(together.of(index(ends[i][0])))];
      const Vec3 a = point(open[i].low), b = point(open[i].high);
      if (number < 0) {
        number = static_cast<int>(result_.loops.size());
        result_.loops.push_back({0, 0, 0, a});
        boxes.emplace_back();
      }
      auto& loop = result_.loops[at(number)];
      ++loop.n_edges;
      loop.length += norm(b - a);
      auto& box = boxes[at(number)];
      box.extend(a);
      box.extend(b);
      loop.size = box.diagonal();
    }
    std::stable_sort(result_.loops.begin(), result_.loops.end(),
                     [](const Loop& a, const Loop& b) { return a.size > b.size; });
    (void)whole;
  }

  void list_shells(const Triangulation& whole) {
    auto shells = geometry::find_shells(whole);
    if (options_.find_self_intersections && result_.is_surface()) {
      const auto found = geometry::nest_shells(whole, shells);
      result_.self_intersections = Found{found.n_pairs, found.first.where};
      for (const auto& contact : shells.contact) note(result_.shell_contacts, contact.where);
      if (shells.shell.size() > 1)
        for (const int i : geometry::turned_shells(shells)) note(result_.turned_shells, shells.shell[at(i)].where);
    }
    result_.shells = std::move(shells.shell);
    std::stable_sort(result_.shells.begin(), result_.shells.end(),
                     [](const auto& a, const auto& b) { return a.area > b.area; });
  }

  void find_deviation() {
    const auto features = geometry::find_features(surface_, {.angle = options_.feature_angle});
    Deviation deviation;
    double sum = 0, area = 0;
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
      const auto p = corners(t);
      const double here = 0.5 * norm(cross(p[1] - p[0], p[2] - p[0]));
      area += here;
      if (features.is_planar[at(features.patch[t])] != 0) continue;
      std::array<std::array<Vec3, 2>, 3> inner;
      for (std::size_t k = 0; k < 3; ++k) inner[k] = edge_curve(features, t, k, p);
      const double off =
          norm(geometry::CurvedTriangle(p, inner).point(1.0 / 3, 1.0 / 3) - (1.0 / 3) * (p[0] + p[1] + p[2]));
      sum += here * off;
      if (off > deviation.worst) {
        deviation.worst = off;
        deviation.where = p[0];
      }
    }
    deviation.mean = area > 0 ? sum / area : 0;
    result_.deviation = deviation;
  }

  static std::array<Vec3, 2> edge_curve(const geometry::Features& features, std::size_t t, std::size_t k,
                                        const std::array<Vec3, 3>& p) {
    const auto next = (k + 1) % 3;
    const int number = features.crease_at[t][k];
    if (number < 0) return geometry::smooth_edge(p[k], p[next], features.normal[t][k], features.normal[t][next]);
    const auto& crease = features.creases[at(number)];
    // A crease runs as in its first triangle.
    const bool is_first =
        features.neighbor[t][k].triangle < 0 || features.neighbor[t][k].triangle > static_cast<int>(t);
    const Vec3 here = is_first ? crease.tangent[0] : -crease.tangent[1];
    const Vec3 there = is_first ? crease.tangent[1] : -crease.tangent[0];
    return {geometry::inner_point(p[k], p[next], here), geometry::inner_point(p[next], p[k], -there)};
  }

  const Triangulation& surface_;
  DescribeOptions options_;
  Description result_;
};

}  // namespace

bool Description::is_surface() const {
  return n_triangles > 0 && flat_triangles.count == 0 && duplicate_triangles.count == 0 &&
         non_manifold_edges.count == 0 && non_manifold_points.count == 0 && turned_edges.count == 0;
}

bool Description::is_body() const {
  return is_surface() && is_closed() && volume > 0 && self_intersections && self_intersections->count == 0 &&
         turned_shells.count == 0;
}

Description describe(const geometry::Triangulation& surface, const DescribeOptions& options) {
  return Describer(surface, options).describe();
}

std::vector<std::string> faults_of(const Description& d) {
  std::vector<std::string> faults;
  const auto add = [&](const Found& found, const char* one, const char* several) {
    if (found.count == 0) return;
    faults.push_back(fmt::format("{} {}, the first at {}", found.count, found.count == 1 ? one : several,
                                 geometry::decimal(found.where)));
  };
  if (d.n_triangles == 0) faults.push_back("no triangles");
  add(d.flat_triangles, "triangle without area", "triangles without area");
  add(d.duplicate_triangles, "triangle twice", "triangles twice");
  add(d.non_manifold_edges, "edge with more than two triangles", "edges with more than two triangles");
  add(d.non_manifold_points, "point where several fans of triangles meet",
      "points where several fans of triangles meet");
  add(d.turned_edges, "edge between triangles of opposite orientation",
      "edges between triangles of opposite orientation");
  if (d.open_edges.count > 0)
    faults.push_back(fmt::format("{} open {} in {} {}, the largest {:.3g} wide at {}", d.open_edges.count,
                                 d.open_edges.count == 1 ? "edge" : "edges", d.loops.size(),
                                 d.loops.size() == 1 ? "hole" : "holes", d.loops.front().size,
                                 geometry::decimal(d.loops.front().where)));
  if (d.self_intersections && d.self_intersections->count > 0)
    faults.push_back(fmt::format("{} {} of triangles that touch or cut each other, the first near {}",
                                 d.self_intersections->count, d.self_intersections->count == 1 ? "pair" : "pairs",
                                 geometry::decimal(d.self_intersections->where)));
  add(d.shell_contacts, "pair of shells that touch or cut each other: what is inside is not defined there",
      "pairs of shells that touch or cut each other: what is inside is not defined there");
  add(d.turned_shells, "shell seen from the wrong side: those inside of another one face inwards, the others outwards",
      "shells seen from the wrong side: those inside of another one face inwards, the others outwards");
  if (d.is_surface() && d.is_closed() && d.turned_shells.count == 0 && !(d.volume > 0))
    faults.push_back(fmt::format("volume {:.6g}: the triangles are seen from inside", d.volume));
  return faults;
}

}  // namespace pamr::surface_mesh
