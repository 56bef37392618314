// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>

#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/refine/split_pattern.hpp"

namespace pamr::refine {

/// Positions by node code: 0..3 corners, 4 + e midpoint of edge e.
using SplitPoints = std::array<geometry::Vec3, 10>;

/// Points of one child of a split cell.
inline geometry::TetPoints child_points(const SplitPoints& points, int state, int child) {
  const auto& code = split_pattern[at(state)].child_to_node[at(child)];
  return {points[at(code[0])], points[at(code[1])], points[at(code[2])], points[at(code[3])]};
}

/// Of a cell with these corners, the midpoints in the middle of their edges.
SplitPoints straight_points(const geometry::TetPoints& corner);

/// Grows with the mean ratio, without its roots: V^2 / (sum of squared edges)^3 with the sign of V. `cube_of_shape`
/// times that is the third power of the mean ratio.
double shape(const geometry::TetPoints& p);
inline constexpr double cube_of_shape = 15552;  // 12^3 9
inline double shape(double volume, double squared_edges) {
  return volume * std::abs(volume) / (squared_edges * squared_edges * squared_edges);
}

/// Shape of the worst child of that state.
double worst_child_shape(const SplitPoints& points, int state);

/// True when every child of that state has positive volume by exact arithmetic.
bool all_children_positive(const SplitPoints& points, int state);

/// True when every midpoint lies in the middle of its edge. `mask`: edges to look at.
bool is_straight(const SplitPoints& points, EdgeMask mask = all_edges);

/// True when halving the edges of this cell, and once more those of its children, cannot invert a child: its volume
/// is far above what the rounding of midpoints (half a unit in the last place of the largest coordinate) can change.
bool is_far_from_flat(const SplitPoints& points);

/// The inner diagonal of 1:8: the shortest; among those equal to rounding (squared length within a factor 1 + 2^-40)
/// the one whose worst inner cell is best; then by coordinates. Never depends on numbering. `is_straight`: every
/// midpoint lies in the middle of its edge. Otherwise only diagonals whose four inner cells are positive by exact
/// arithmetic are looked at, unless there is none. Source: S. Zhang, Houston J. Math. 21 (1995) for the shortest
/// diagonal; Kuhn cells tie.
int choose_diagonal(const SplitPoints& points, bool is_straight);

}  // namespace pamr::refine
