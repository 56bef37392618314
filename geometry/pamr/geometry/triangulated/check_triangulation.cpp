// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/check_triangulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/geometry/triangulated/edge_table.hpp"

namespace pamr::geometry {

namespace {

constexpr double min_height = 1e-10;

[[noreturn]] void fail(const std::string& where, int triangle, const std::string& message) {
  throw Error(fmt::format("{}: triangle {}: {}", where, triangle + 1, message));
}

void require_shapes(const Triangulation& surface, const std::string& where) {
  const auto n_points = static_cast<int>(surface.points.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& corner = surface.triangles[t];
    const auto number = static_cast<int>(t);
    for (const int p : corner) {
      if (p < 0 || p >= n_points)
        fail(where, number, fmt::format("expected points from 1 to {}, found {}", n_points, p + 1));
      if (!is_in_range(surface.points[at(p)]))
        fail(where, number,
             fmt::format("expected finite coordinates below {}, found {}", max_coordinate_text,
                         decimal(surface.points[at(p)])));
    }
    const Vec3 a = surface.points[at(corner[0])], b = surface.points[at(corner[1])], c = surface.points[at(corner[2])];
    const double longest = std::sqrt(std::max({squared_norm(b - a), squared_norm(c - b), squared_norm(a - c)}));
    if (!(longest > min_length) || !(norm(cross((1 / longest) * (b - a), (1 / longest) * (c - a))) > min_height))
      fail(where, number, "expected three corners that span an area, found none at " + decimal(a));
  }
}

/// Edges with one triangle only.
std::size_t count_open(const EdgeTable& edges) {
  std::size_t n = 0;
  edges.for_each_edge([&](std::span<const Side> sides) { n += sides.size() == 1 ? 1 : 0; });
  return n;
}

void require_edges(const Triangulation& surface, const EdgeTable& edges, const std::string& where, bool open_allowed) {
  edges.for_each_edge([&](std::span<const Side> sides) {
    const auto text = "the edge from " + decimal(surface.points[at(sides[0].low)]) + " to " +
                      decimal(surface.points[at(sides[0].high)]);
    if (sides.size() > 2)
      fail(where, sides[2].triangle,
           fmt::format("expected at most two triangles at {}, found {} (non-manifold)", text, sides.size()));
    if (sides.size() == 1 && !open_allowed)
      fail(where, sides[0].triangle,
           fmt::format(
               "expected a closed surface, found {} edges with one triangle, the first {} (open); if that is meant, "
               "describe the surface in TOML with open = true",
               count_open(edges), text.substr(std::string("the edge ").size())));
    if (sides.size() == 2 && sides[0].upwards == sides[1].upwards)
      fail(where, sides[1].triangle,
           fmt::format("expected the opposite sense of triangle {} at {}, found the same (orientation)",
                       sides[0].triangle + 1, text));
  });
}

/// Follows the triangles around each point; those that the first fan does not reach make it non-manifold.
void require_fans(const Triangulation& surface, const std::vector<std::array<Beyond, 3>>& neighbors,
                  const std::string& where) {
  std::vector<int> n_around(surface.points.size(), 0), first(surface.points.size(), -1), corner_of(first);
  for (std::size_t t = surface.triangles.size(); t-- > 0;)
    for (int k = 0; k < 3; ++k) {
      const auto p = at(surface.triangles[t][at(k)]);
      ++n_around[p];
      first[p] = static_cast<int>(t);
      corner_of[p] = k;
    }
  for (std::size_t p = 0; p < surface.points.size(); ++p) {
    if (first[p] < 0) continue;
    int n = 1;
    // Out over the edge that starts at the corner; when that ends, back over the one that ends there.
    int t = first[p], k = corner_of[p];
    bool is_closed = false;
    for (;;) {
      const auto [next, edge] = neighbors[at(t)][at(k)];
      if (next < 0) break;
      t = next;
      k = (edge + 1) % 3;
      if (t == first[p]) {
        is_closed = true;
        break;
      }
      ++n;
    }
    for (t = first[p], k = corner_of[p]; !is_closed; ++n) {
      const auto [next, edge] = neighbors[at(t)][at((k + 2) % 3)];
      if (next < 0) break;
      t = next;
      k = edge;
    }
    if (n != n_around[p])
      fail(where, first[p],
           fmt::format("expected the triangles at point {} joined to one fan, found {} of {} apart (non-manifold)",
                       decimal(surface.points[p]), n_around[p] - n, n_around[p]));
  }
}

}  // namespace

void drop_unused_points(Triangulation& surface) {
  std::vector<int> new_number(surface.points.size(), -1);
  for (const auto& corner : surface.triangles)
    for (const int p : corner) new_number[at(p)] = 0;
  int n = 0;
  for (std::size_t p = 0; p < new_number.size(); ++p) {
    if (new_number[p] < 0) continue;
    surface.points[at(n)] = surface.points[p];
    new_number[p] = n++;
  }
  surface.points.resize(at(n));
  for (auto& corner : surface.triangles)
    for (int& p : corner) p = new_number[at(p)];
}

void require_valid(const Triangulation& surface, const std::string& where, Exact<bool> open_allowed) {
  if (surface.triangles.empty()) throw Error(where + ": expected triangles, found none (empty)");
  require_shapes(surface, where);
  require_edges(surface, EdgeTable(surface), where, open_allowed);
  require_fans(surface, triangle_neighbors(surface), where);
}

std::vector<std::array<Beyond, 3>> triangle_neighbors(const Triangulation& surface) {
  std::vector<std::array<Beyond, 3>> neighbors(surface.triangles.size());
  EdgeTable(surface).for_each_edge([&](std::span<const Side> sides) {
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
      const Side &a = sides[i], &b = sides[i + 1];
      neighbors[at(a.triangle)][at(a.edge)] = {b.triangle, b.edge};
      neighbors[at(b.triangle)][at(b.edge)] = {a.triangle, a.edge};
    }
  });
  return neighbors;
}

}  // namespace pamr::geometry
