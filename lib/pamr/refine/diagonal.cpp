// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/diagonal.hpp"

#include <algorithm>

#include "pamr/geometry/orientation.hpp"

namespace pamr::refine {

namespace {

using geometry::Vec3;

constexpr double rounding = 1.0 + 0x1p-40;

double worst_inner_shape(const SplitPoints& points, int diagonal) {
  double worst = shape(child_points(points, 11 + diagonal, 4));
  for (int child = 5; child < 8; ++child) worst = std::min(worst, shape(child_points(points, 11 + diagonal, child)));
  return worst;
}

bool inner_children_positive(const SplitPoints& points, int diagonal) {
  for (int child = 4; child < 8; ++child) {
    const auto p = child_points(points, 11 + diagonal, child);
    if (!geometry::is_positive(p[0], p[1], p[2], p[3])) return false;
  }
  return true;
}

std::array<Vec3, 2> ends_in_order(const SplitPoints& points, int diagonal) {
  const auto p = points[static_cast<std::size_t>(4 + diagonal)];
  const auto q = points[static_cast<std::size_t>(4 + mesh::tet::opposite_edge(diagonal))];
  return geometry::lexicographically_less(p, q) ? std::array{p, q} : std::array{q, p};
}

bool earlier_by_coordinates(const SplitPoints& points, int a, int b) {
  const auto p = ends_in_order(points, a), q = ends_in_order(points, b);
  return p[0] == q[0] ? geometry::lexicographically_less(p[1], q[1]) : geometry::lexicographically_less(p[0], q[0]);
}

}  // namespace

double shape(const geometry::TetPoints& p) {
  const double v = geometry::volume(p);
  double squares = 0;
  for (const auto [a, b] : mesh::tet::edge_to_corner)
    squares += geometry::squared_norm(p[static_cast<std::size_t>(a)] - p[static_cast<std::size_t>(b)]);
  return v * std::abs(v) / (squares * squares * squares);
}

bool all_children_positive(const SplitPoints& points, int state) {
  for (int child = 0; child < split_pattern[static_cast<std::size_t>(state)].n_children; ++child) {
    const auto p = child_points(points, state, child);
    if (!geometry::is_positive(p[0], p[1], p[2], p[3])) return false;
  }
  return true;
}

int choose_diagonal(const SplitPoints& points, bool must_be_positive) {
  std::array<bool, 3> allowed{true, true, true};
  if (must_be_positive) {
    for (int d = 0; d < 3; ++d) allowed[static_cast<std::size_t>(d)] = inner_children_positive(points, d);
    if (std::none_of(allowed.begin(), allowed.end(), [](bool b) { return b; })) allowed.fill(true);
  }
  std::array<double, 3> squared_length{};
  double shortest = -1;
  for (int d = 0; d < 3; ++d) {
    squared_length[static_cast<std::size_t>(d)] = geometry::squared_norm(
        points[static_cast<std::size_t>(4 + d)] - points[static_cast<std::size_t>(4 + mesh::tet::opposite_edge(d))]);
    if (allowed[static_cast<std::size_t>(d)] &&
        (shortest < 0 || squared_length[static_cast<std::size_t>(d)] < shortest))
      shortest = squared_length[static_cast<std::size_t>(d)];
  }
  int best = -1;
  double best_shape = 0;
  int n_tied = 0;
  for (int d = 0; d < 3; ++d) {
    auto& is_allowed = allowed[static_cast<std::size_t>(d)];
    is_allowed = is_allowed && squared_length[static_cast<std::size_t>(d)] <= rounding * shortest;
    if (is_allowed) {
      best = d;
      ++n_tied;
    }
  }
  if (n_tied == 1) return best;

  std::array<double, 3> worst{};
  for (int d = 0; d < 3; ++d)
    if (allowed[static_cast<std::size_t>(d)]) {
      worst[static_cast<std::size_t>(d)] = worst_inner_shape(points, d);
      best_shape = std::max(best_shape, worst[static_cast<std::size_t>(d)]);
    }
  best = -1;
  for (int d = 0; d < 3; ++d) {
    const bool tied = allowed[static_cast<std::size_t>(d)] &&
                      worst[static_cast<std::size_t>(d)] * rounding * rounding * rounding >= best_shape;
    if (tied && (best < 0 || earlier_by_coordinates(points, d, best))) best = d;
  }
  return best < 0 ? 0 : best;
}

}  // namespace pamr::refine
