// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/surface_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <utility>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/triangulated/triangle_tree.hpp"
#include "surface_mesh/triangle_shape.hpp"

namespace pamr::surface_mesh {

namespace {

using geometry::Triangulation;
using geometry::Vec3;

/// A point with the nearest triangle of the other surface.
struct Probe {
  Vec3 point;
  int nearest = -1;
  double distance = 0;
};

using Polygon = std::vector<Vec3>;  // convex, plane

Vec3 center_of(const Polygon& polygon) {
  Vec3 sum;
  for (const Vec3 p : polygon) sum = sum + p;
  return (1.0 / static_cast<double>(polygon.size())) * sum;
}

/// The parts of a convex polygon on either side of a plane, `side` positive and not.
struct Halves {
  Polygon positive, other;
};

template <class Side>
Halves cut(const Polygon& polygon, Side&& side) {
  Halves parts;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 p = polygon[i], q = polygon[(i + 1) % polygon.size()];
    const double a = side(p), b = side(q);
    (a > 0 ? parts.positive : parts.other).push_back(p);
    if ((a > 0) == (b > 0)) continue;
    const Vec3 between = p + (a / (a - b)) * (q - p);
    parts.positive.push_back(between);
    parts.other.push_back(between);
  }
  return parts;
}

/// From one corner to another, the longest of these.
struct Line {
  Vec3 from, to;
  double length() const { return norm(to - from); }
};

Line longest_line(const Polygon& polygon) {
  Line longest;
  for (const Vec3 p : polygon)
    for (const Vec3 q : polygon)
      if (const Line line{p, q}; line.length() > longest.length()) longest = line;
  return longest;
}

Halves halve(const Polygon& polygon, const Line& longest) {
  const Vec3 middle = midpoint(longest.from, longest.to), along = longest.to - longest.from;
  return cut(polygon, [&](Vec3 p) { return dot(p - middle, along); });
}

/// A triangle or a part of one that may hold a point farther than the largest distance found so far.
struct Piece {
  double bound = 0;
  Polygon polygon;
  int triangle = -1;  // of the surface
  friend bool operator<(const Piece& a, const Piece& b) { return a.bound < b.bound; }
};

class Measurement {
 public:
  Measurement(const Triangulation& from, const Triangulation& to, const DistanceOptions& options)
      : from_(from), to_(to), options_(options), tree_(all_corners(to)), is_known_far_(from.triangles.size(), 0) {}

  SurfaceDistance run() {
    std::vector<Probe> probes;
    probes.reserve(from_.points.size());
    for (const Vec3 p : from_.points) probes.push_back(probe(p));
    note_used(probes);
    for (int t = 0; t < std::ssize(from_.triangles); ++t) {
      const auto& [a, b, c] = from_.triangles[at(t)];
      push({probes[at(a)], probes[at(b)], probes[at(c)]}, t);
    }
    while (!waiting_.empty() && waiting_.top().bound > good_enough() && n_queries_ < options_.max_queries)
      split_worst();
    result_.at_most = std::max(dropped_bound_, result_.at_least);
    if (!waiting_.empty()) result_.at_most = std::max(result_.at_most, waiting_.top().bound);
    for (; options_.enough > 0 && !waiting_.empty() && waiting_.top().bound > options_.enough; waiting_.pop())
      note_far(waiting_.top().triangle, probe(center_of(waiting_.top().polygon)));
    return std::move(result_);
  }

 private:
  /// What lies above the triangle next to the middle is cut off, since the distance from that one is all that counts
  /// there.
  void split_worst() {
    auto [bound, polygon, triangle] = waiting_.top();
    waiting_.pop();
    if (is_known_far_[at(triangle)] != 0) return drop(bound);  // pieces at the end of the far part never get small
    const auto middle = probe(center_of(polygon));
    ++n_queries_;
    note(middle);
    double radius = 0;
    for (const Vec3 p : polygon) radius = std::max(radius, norm(p - middle.point));
    bound = std::min({bound, worst_from(polygon, middle.nearest), middle.distance + radius});
    if (is_far(middle)) note_far(triangle, middle);
    if (is_far(middle) || bound <= good_enough()) return drop(bound);
    const auto corner = corners_of(to_, at(middle.nearest));
    const Vec3 normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const double length = longest_line(polygon).length();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 inwards = cross(normal, corner[(k + 1) % 3] - corner[k]);
      auto parts = cut(polygon, [&](Vec3 p) { return dot(p - corner[k], inwards); });
      if (parts.positive.empty()) break;
      wait(parts.other, length, {bound, triangle, middle.nearest});
      polygon = std::move(parts.positive);
    }
    wait(polygon, length, {bound, triangle, middle.nearest});
  }

  struct Known {
    double bound = 0;
    int triangle = -1, nearest = -1;
  };

  /// What is not much shorter than the whole was, is halved: cutting may have taken next to nothing off.
  void wait(const Polygon& polygon, double length_before, const Known& known) {
    constexpr double much = 0.75;
    if (polygon.empty()) return;
    const double bound = std::min(known.bound, worst_from(polygon, known.nearest));
    if (bound <= good_enough()) return drop(bound);
    const auto longest = longest_line(polygon);
    if (longest.length() <= much * length_before) return waiting_.push({bound, polygon, known.triangle});
    const auto parts = halve(polygon, longest);
    for (const auto* part : {&parts.positive, &parts.other})
      if (!part->empty()) waiting_.push({bound, *part, known.triangle});
  }

  void drop(double bound) { dropped_bound_ = std::max(dropped_bound_, bound); }

  Probe probe(Vec3 point) const {
    const auto hit = tree_.nearest(point);
    return {point, hit.triangle, distance(point, hit.triangle)};
  }

  double distance(Vec3 point, int triangle) const {
    const auto p = corners_of(to_, at(triangle));
    const Vec3 ab = p[1] - p[0], ac = p[2] - p[0], ap = point - p[0];
    const auto [u, v] = geometry::nearest_parameters(ab, ac, ap);
    return norm(ap - u * ab - v * ac);
  }

  void note(const Probe& found) {
    if (!(found.distance > result_.at_least)) return;
    result_.at_least = found.distance;
    result_.where = found.point;
  }

  void note_used(const std::vector<Probe>& probes) {
    for (const auto& corner : from_.triangles)
      for (const int n : corner) note(probes[at(n)]);
  }

  double good_enough() const {
    return options_.enough > 0 ? options_.enough : (1 + options_.precision) * result_.at_least;
  }

  /// What is near enough by its bound is done with, and so is what is known to be too far.
  void push(const std::array<Probe, 3>& corner, int triangle) {
    const double bound = bound_of(corner);
    bool has_far = false;
    for (const auto& p : corner)
      if (is_far(p)) {
        has_far = true;
        note_far(triangle, p);
      }
    if (has_far || bound <= good_enough()) return drop(bound);
    waiting_.push({bound, {corner[0].point, corner[1].point, corner[2].point}, triangle});
  }

  bool is_far(const Probe& p) const { return options_.enough > 0 && p.distance > options_.enough; }
  void note_far(int triangle, const Probe& p) {
    is_known_far_[at(triangle)] = 1;
    result_.far.push_back({p.point, triangle, p.nearest});
  }

  double bound_of(const std::array<Probe, 3>& corner) const {
    double least = lipschitz_bound(corner);
    const Polygon polygon{corner[0].point, corner[1].point, corner[2].point};
    for (const auto& candidate : corner) least = std::min(least, worst_from(polygon, candidate.nearest));
    return least;
  }

  /// The distance from one flat triangle is convex, so over a convex polygon it is largest in a corner.
  double worst_from(const Polygon& polygon, int triangle) const {
    double worst = 0;
    for (const Vec3 p : polygon) worst = std::max(worst, distance(p, triangle));
    return worst;
  }

  /// No point of a piece is farther from its nearest corner than this part of the longest side: the radius of the
  /// circle through the corners if no angle is obtuse, less than half of that side otherwise.
  static double lipschitz_bound(const std::array<Probe, 3>& corner) {
    const double longest = std::max({norm(corner[1].point - corner[2].point), norm(corner[2].point - corner[0].point),
                                     norm(corner[0].point - corner[1].point)});
    return std::max({corner[0].distance, corner[1].distance, corner[2].distance}) + longest / std::sqrt(3.0);
  }

  const Triangulation& from_;
  const Triangulation& to_;
  DistanceOptions options_;
  geometry::TriangleTree tree_;
  SurfaceDistance result_;
  std::priority_queue<Piece> waiting_;
  std::vector<char> is_known_far_;  // triangles of `from`
  double dropped_bound_ = 0;
  std::int64_t n_queries_ = 0;
};

}  // namespace

SurfaceDistance distance_from_to(const Triangulation& from, const Triangulation& to, const DistanceOptions& options) {
  return Measurement(from, to, options).run();
}

}  // namespace pamr::surface_mesh
