// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/improve_node.hpp"

#include <algorithm>
#include <limits>

#include "pamr/base/index.hpp"

namespace pamr::meshing {

Stars::Stars(std::span<geometry::Vec3> points, std::span<const std::array<std::int32_t, 4>> cells)
    : point(points), cell(cells), offset(points.size() + 1, 0) {
  for (const auto& c : cell)
    for (const auto node : c) ++offset[at(node) + 1];
  for (std::size_t i = 1; i < offset.size(); ++i) offset[i] += offset[i - 1];
  star.resize(offset.back());
  auto next = offset;
  for (std::size_t c = 0; c < cell.size(); ++c)
    for (const auto node : cell[c]) star[next[at(node)]++] = c;
}

geometry::TetPoints Stars::points(std::size_t c) const {
  const auto& node = cell[c];
  return {point[at(node[0])], point[at(node[1])], point[at(node[2])], point[at(node[3])]};
}

double worst_ratio(const Stars& stars, std::size_t node, double enough) {
  double worst = std::numeric_limits<double>::infinity();
  for (const auto c : stars.at_node(node)) {
    worst = std::min(worst, geometry::mean_ratio(stars.points(c)));
    if (worst <= enough) break;
  }
  return worst;
}

double shortest_edge(const Stars& stars, std::size_t node) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const auto c : stars.at_node(node))
    for (const auto other : stars.cell[c])
      if (at(other) != node) shortest = std::min(shortest, geometry::norm(stars.point[at(other)] - stars.point[node]));
  return shortest;
}

}  // namespace pamr::meshing
