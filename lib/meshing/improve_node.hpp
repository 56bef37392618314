// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "pamr/geometry/tet_shape.hpp"
#include "pamr/geometry/vec3.hpp"

namespace pamr::meshing {

/// Cells of which nodes move, and the cells at each node. Refers to the arrays that it is made from.
struct Stars {
  std::span<geometry::Vec3> point;                    ///< n_nodes
  std::span<const std::array<std::int32_t, 4>> cell;  ///< n_cells x 4 nodes
  /// The cells at node i are `star[offset[i] .. offset[i+1])`, ascending.
  std::vector<std::size_t> offset, star;

  Stars(std::span<geometry::Vec3> points, std::span<const std::array<std::int32_t, 4>> cells);

  std::span<const std::size_t> at_node(std::size_t node) const {
    return std::span(star).subspan(offset[node], offset[node + 1] - offset[node]);
  }
  geometry::TetPoints points(std::size_t c) const;
};

/// Value of a place where a node must not be: below all ratios.
inline constexpr double refused = -std::numeric_limits<double>::infinity();

/// The smallest mean ratio of the cells at a node, or another number that is no larger than `enough` if that is not
/// above it; infinity without cells. Local.
double worst_ratio(const Stars& stars, std::size_t node, double enough);

/// Length of the shortest edge at a node; infinity without cells. Local.
double shortest_edge(const Stars& stars, std::size_t node);

/// Moves a node to where its `value` is largest. Tries the 26 neighbors in a cube around the best place so far, in ever
/// smaller cubes, first of a fifth of the shortest edge. `bind(p)` is the place of a node that is wanted at p.
/// `value(ratio)` is called with the node there, `ratio` the smallest mean ratio of the cells at it, and is no larger
/// than that; `best` is what the node begins with. True if the node moved. Local, deterministic.
template <class Bind, class Value>
bool improve_node(const Stars& stars, std::size_t node, double best, const Bind& bind, const Value& value) {
  auto& place = stars.point[node];
  const auto start = place;
  const double length = shortest_edge(stars, node);
  auto best_place = start;
  for (double step = 0.2; step > 0.01; step *= 0.5) {
    const auto center = best_place;
    for (int direction = 0; direction < 27; ++direction) {
      if (direction == 13) continue;  // the center
      const int x = direction % 3, y = direction / 3 % 3, z = direction / 9;
      const geometry::Vec3 d{x - 1.0, y - 1.0, z - 1.0};
      place = bind(center + step * length / geometry::norm(d) * d);
      const double ratio = worst_ratio(stars, node, best);
      if (!(ratio > best)) continue;
      const double here = value(ratio);
      if (!(here > best)) continue;
      best = here;
      best_place = place;
    }
  }
  place = best_place;
  return !(place == start);
}

}  // namespace pamr::meshing
