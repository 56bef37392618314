// SPDX-License-Identifier: GPL-3.0-or-later
// Speed of queries of a triangulated surface: a torus of 2 N x N squares, each cut into two triangles.
//
//   bench_surface [N [QUERIES]]     N (default 160: 102,400 triangles), queries of each kind (default 200,000)
//
// Prints the processor time of building, the time for finding triangles that cut each other, and millions of queries
// per second of processor time: nearest points of places in random order near the surface, the same in the order of the
// surface (middles of its edges, as a refinement asks for), far places, and signed distances.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>
#include <vector>

#include "pamr/base/timer.hpp"
#include "pamr/geometry/triangulated/self_intersection.hpp"
#include "pamr/geometry/triangulated/triangulated_surface.hpp"

namespace {

using namespace pamr;
using geometry::Vec3;

Vec3 on_torus(double u, double v, double tube) {
  const double a = 2 * std::numbers::pi * u, b = 2 * std::numbers::pi * v, r = 1 + tube * std::cos(b);
  return {r * std::cos(a), r * std::sin(a), tube * std::sin(b)};
}

geometry::Triangulation torus(int n) {
  geometry::Triangulation surface;
  for (int i = 0; i < 2 * n; ++i)
    for (int j = 0; j < n; ++j) surface.points.push_back(on_torus(i / (2.0 * n), j / static_cast<double>(n), 0.4));
  const auto at = [n](int i, int j) { return i % (2 * n) * n + j % n; };
  for (int i = 0; i < 2 * n; ++i)
    for (int j = 0; j < n; ++j) {
      surface.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      surface.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return surface;
}

template <class Query>
void time_queries(const char* what, const std::vector<Vec3>& points, const Query& query) {
  const double start = cpu_seconds();
  double sum = 0;  // keeps the work from being left out
  for (const Vec3 p : points) sum += query(p);
  const double seconds = cpu_seconds() - start;
  std::printf("%s: %.2f M/s (mean %.3g)\n", what, 1e-6 * static_cast<double>(points.size()) / seconds,
              sum / static_cast<double>(points.size()));
}

}  // namespace

int main(int argc, char** argv) {
  const int n = argc > 1 ? std::atoi(argv[1]) : 160, n_queries = argc > 2 ? std::atoi(argv[2]) : 200000;
  const auto triangles = torus(n);
  double start = cpu_seconds();
  const geometry::Triangulated surface(triangles, {});
  std::printf("%zu triangles: built in %.2f s\n", triangles.triangles.size(), cpu_seconds() - start);
  start = cpu_seconds();
  const auto cuts = geometry::find_self_intersections(triangles);
  std::printf("%lld pairs that cut each other, found in %.2f s\n", static_cast<long long>(cuts.n_pairs),
              cpu_seconds() - start);

  std::mt19937 random(1);
  std::uniform_real_distribution<double> part(0, 1);
  std::vector<Vec3> scattered, ordered, far;
  for (int i = 0; i < n_queries; ++i) {
    scattered.push_back(on_torus(part(random), part(random), 0.4 * (0.98 + 0.04 * part(random))));
    far.push_back({4 * part(random) - 2, 4 * part(random) - 2, 2 * part(random) - 1});
  }
  for (std::size_t t = 0; ordered.size() < static_cast<std::size_t>(n_queries);
       t = (t + 1) % triangles.triangles.size()) {
    const auto& [a, b, c] = triangles.triangles[t];
    const auto point = [&](int k) { return triangles.points[static_cast<std::size_t>(k)]; };
    ordered.push_back(midpoint(point(a), point(b)));
    ordered.push_back(midpoint(point(b), point(c)));
  }
  const auto distance = [&](Vec3 p) { return surface.distance(p); };
  time_queries("nearest points, random order", scattered, distance);
  time_queries("nearest points, order of the surface", ordered, distance);
  time_queries("nearest points, far away", far, distance);
  time_queries("signed distances, random order", scattered, [&](Vec3 p) { return surface.signed_distance(p); });
}
