// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/diagonal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pamr/base/index.hpp"
#include "pamr/geometry/orientation.hpp"

namespace pamr::refine {

namespace {

using geometry::Vec3;

constexpr double rounding = 1.0 + 0x1p-40;

double worst_inner_shape(const SplitPoints& points, int diagonal) {
  double worst = shape(child_points(points, regular_state + diagonal, 4));
  for (int child = 5; child < 8; ++child)
    worst = std::min(worst, shape(child_points(points, regular_state + diagonal, child)));
  return worst;
}

bool inner_children_positive(const SplitPoints& points, int diagonal) {
  for (int child = 4; child < 8; ++child) {
    const auto p = child_points(points, regular_state + diagonal, child);
    if (!geometry::is_positive(p[0], p[1], p[2], p[3])) return false;
  }
  return true;
}

std::array<Vec3, 2> ends_in_order(const SplitPoints& points, int diagonal) {
  const auto p = points[at(4 + diagonal)];
  const auto q = points[at(4 + mesh::tet::opposite_edge(diagonal))];
  return geometry::lexicographically_less(p, q) ? std::array{p, q} : std::array{q, p};
}

bool earlier_by_coordinates(const SplitPoints& points, int a, int b) {
  const auto p = ends_in_order(points, a), q = ends_in_order(points, b);
  return p[0] == q[0] ? geometry::lexicographically_less(p[1], q[1]) : geometry::lexicographically_less(p[0], q[0]);
}

/// How good the worst inner cell of each diagonal is in a straight cell, comparable among diagonals of equal length.
/// The four inner cells have an eighth of the volume each, so the one with the largest sum of squared edges is worst.
/// Each has the diagonal, a half of each of the four edges that the diagonal does not join, and a half of one of the
/// two edges that it joins: the worst of the longer one. So the sum is less by the shorter one's share.
std::array<double, 3> worst_straight_shapes(const SplitPoints& points) {
  std::array<double, 6> squared{};
  double all = 0;
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = mesh::tet::edge_to_corner[e];
    squared[e] = geometry::squared_norm(points[at(a)] - points[at(b)]);
    all += squared[e];
  }
  std::array<double, 3> worst{};
  for (std::size_t d = 0; d < 3; ++d) worst[d] = std::min(squared[d], squared[5 - d]) - all;
  return worst;
}

/// Among tied diagonals, those whose worst inner cell is best, equal to rounding.
void keep_best_shaped(const SplitPoints& points, bool is_straight, std::array<bool, 3>& allowed) {
  std::array<double, 3> worst{};
  if (is_straight)
    worst = worst_straight_shapes(points);
  else
    for (std::size_t d = 0; d < 3; ++d)
      if (allowed[d]) worst[d] = worst_inner_shape(points, static_cast<int>(d));
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t d = 0; d < 3; ++d)
    if (allowed[d]) best = std::max(best, worst[d]);
  for (std::size_t d = 0; d < 3; ++d) allowed[d] = allowed[d] && worst[d] >= best - 3 * (rounding - 1) * std::abs(best);
}

}  // namespace

SplitPoints straight_points(const geometry::TetPoints& corner) {
  SplitPoints points;
  std::copy(corner.begin(), corner.end(), points.begin());
  for (int e = 0; e < 6; ++e) {
    const auto [a, b] = mesh::tet::edge_to_corner[at(e)];
    points[at(4 + e)] = geometry::midpoint(corner[at(a)], corner[at(b)]);
  }
  return points;
}

double shape(const geometry::TetPoints& p) {
  double squares = 0;
  for (const auto [a, b] : mesh::tet::edge_to_corner) squares += geometry::squared_norm(p[at(a)] - p[at(b)]);
  return shape(geometry::volume(p), squares);
}

bool is_straight(const SplitPoints& points, EdgeMask mask) {
  for (std::size_t e = 0; e < 6; ++e) {
    if ((mask >> e & 1) == 0) continue;
    const auto [a, b] = mesh::tet::edge_to_corner[e];
    if (!(points[4 + e] == geometry::midpoint(points[at(a)], points[at(b)]))) return false;
  }
  return true;
}

bool is_far_from_flat(const SplitPoints& points) {
  const Vec3 a = points[1] - points[0], b = points[2] - points[0], c = points[3] - points[0];
  const double span = std::max({geometry::squared_norm(a), geometry::squared_norm(b), geometry::squared_norm(c)});
  double largest = 0;
  for (std::size_t i = 0; i < 4; ++i)
    largest = std::max({largest, std::abs(points[i].x), std::abs(points[i].y), std::abs(points[i].z)});
  return geometry::dot(geometry::cross(a, b), c) > 0x1p-41 * (largest + std::sqrt(span)) * span;
}

double worst_child_shape(const SplitPoints& points, int state) {
  double worst = shape(child_points(points, state, 0));
  for (int child = 1; child < split_pattern[at(state)].n_children; ++child)
    worst = std::min(worst, shape(child_points(points, state, child)));
  return worst;
}

bool all_children_positive(const SplitPoints& points, int state) {
  for (int child = 0; child < split_pattern[at(state)].n_children; ++child) {
    const auto p = child_points(points, state, child);
    if (!geometry::is_positive(p[0], p[1], p[2], p[3])) return false;
  }
  return true;
}

int choose_diagonal(const SplitPoints& points, bool is_straight) {
  std::array<bool, 3> allowed{true, true, true};
  if (!is_straight) {
    for (int d = 0; d < 3; ++d) allowed[at(d)] = inner_children_positive(points, d);
    if (std::none_of(allowed.begin(), allowed.end(), [](bool b) { return b; })) allowed.fill(true);
  }
  std::array<double, 3> squared_length{};
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t d = 0; d < 3; ++d) {
    squared_length[d] = geometry::squared_norm(points[4 + d] - points[9 - d]);
    if (allowed[d]) shortest = std::min(shortest, squared_length[d]);
  }
  int n_tied = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    allowed[d] = allowed[d] && squared_length[d] <= rounding * shortest;
    n_tied += allowed[d] ? 1 : 0;
  }
  if (n_tied > 1) keep_best_shaped(points, is_straight, allowed);
  int best = -1;
  for (int d = 0; d < 3; ++d)
    if (allowed[at(d)] && (best < 0 || earlier_by_coordinates(points, d, best))) best = d;
  return best;
}

}  // namespace pamr::refine
