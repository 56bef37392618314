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

namespace pamr::surface_mesh {

namespace {

using geometry::Triangulation;
using geometry::Vec3;

std::array<Vec3, 3> corners_of(const Triangulation& surface, int triangle) {
  const auto& [a, b, c] = surface.triangles[at(triangle)];
  return {surface.points[at(a)], surface.points[at(b)], surface.points[at(c)]};
}

/// A point with the nearest triangle of the other surface.
struct Probe {
  Vec3 point;
  int nearest = -1;
  double distance = 0;
};

/// A triangle or a part of one that may hold a point farther than the largest distance found so far.
struct Piece {
  double bound = 0;
  std::array<Probe, 3> corner;
  int triangle = -1;  // of the surface
  friend bool operator<(const Piece& a, const Piece& b) { return a.bound < b.bound; }
};

class Measurement {
 public:
  Measurement(const Triangulation& from, const Triangulation& to, const DistanceOptions& options)
      : from_(from), to_(to), options_(options), tree_(all_corners(to)) {}

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
    for (auto* list : {&result_.far_from, &result_.far_to}) {
      std::sort(list->begin(), list->end());
      list->erase(std::unique(list->begin(), list->end()), list->end());
    }
    return std::move(result_);
  }

 private:
  static std::vector<std::array<Vec3, 3>> all_corners(const Triangulation& surface) {
    std::vector<std::array<Vec3, 3>> corners;
    corners.reserve(surface.triangles.size());
    for (int t = 0; t < std::ssize(surface.triangles); ++t) corners.push_back(corners_of(surface, t));
    return corners;
  }

  void split_worst() {
    const auto [bound, corner, triangle] = waiting_.top();
    waiting_.pop();
    const auto& [p, q, r] = corner;
    const auto pq = probe(midpoint(p.point, q.point)), qr = probe(midpoint(q.point, r.point)),
               rp = probe(midpoint(r.point, p.point));
    n_queries_ += 3;
    for (const auto& found : {pq, qr, rp}) note(found);
    for (const auto& part :
         {std::array{p, pq, rp}, std::array{pq, q, qr}, std::array{rp, qr, r}, std::array{pq, qr, rp}})
      push(part, triangle);
  }

  Probe probe(Vec3 point) const {
    const auto hit = tree_.nearest(point);
    return {point, hit.triangle, distance(point, hit.triangle)};
  }

  double distance(Vec3 point, int triangle) const {
    const auto p = corners_of(to_, triangle);
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
    const bool is_far = options_.enough > 0 && std::any_of(corner.begin(), corner.end(), [&](const Probe& p) {
                          return p.distance > options_.enough;
                        });
    if (is_far) {
      result_.far_from.push_back(triangle);
      for (const auto& p : corner)
        if (p.distance > options_.enough) result_.far_to.push_back(p.nearest);
    }
    if (!is_far && bound > good_enough())
      waiting_.push({bound, corner, triangle});
    else
      dropped_bound_ = std::max(dropped_bound_, bound);
  }

  /// The distance from one flat triangle is convex, so over a piece it is largest in a corner.
  double bound_of(const std::array<Probe, 3>& corner) const {
    double least = lipschitz_bound(corner);
    for (const auto& candidate : corner) {
      double worst = 0;
      for (const auto& c : corner)
        worst = std::max(worst, c.nearest == candidate.nearest ? c.distance : distance(c.point, candidate.nearest));
      least = std::min(least, worst);
    }
    return least;
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
  double dropped_bound_ = 0;
  std::int64_t n_queries_ = 0;
};

}  // namespace

SurfaceDistance distance_from_to(const Triangulation& from, const Triangulation& to, const DistanceOptions& options) {
  return Measurement(from, to, options).run();
}

}  // namespace pamr::surface_mesh
