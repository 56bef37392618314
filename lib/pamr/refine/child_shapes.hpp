// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "pamr/base/index.hpp"
#include "pamr/mesh/closure_state.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/refine/split_pattern.hpp"

/// The different shapes that the children of a cell may have, over all ways to split it, as constant tables.
namespace pamr::refine {

inline constexpr std::size_t max_child_shapes = 141;

/// A cell whose nodes are corners and midpoints of its parent.
struct ChildShape {
  std::array<std::int8_t, 4> nodes{};  ///< by code, oriented as the parent
  unsigned codes = 0;                  ///< bits of the nodes
  std::array<std::uint8_t, 6> pair{};  ///< the ends of its edges, see `pair_of`
  /// Four times the sum of its squared edges is the sum of the parent's squared edges with these factors.
  std::array<double, 6> factor{};
  double squared_volume = 0;  ///< of eight times its volume, over that of the parent's
};

/// The number of two points by code, below 100.
constexpr std::size_t pair_of(int a, int b) { return at(10 * (a > b ? a : b) + (a > b ? b : a)); }

/// Shapes by number, and the number of each child's.
struct ShapeTable {
  std::array<ChildShape, max_child_shapes> shape{};
  /// Of the children of each closure state; beyond the last one its first again.
  std::array<std::array<std::uint8_t, max_children>, mesh::closure_states.size()> of_child{};
  std::array<std::array<std::uint8_t, 4>, 3> of_inner{};  ///< of the inner cells of 1:8 by their diagonal
  /// Sets of marks that have states with a child of that shape, by whatever cuts: bit m for the set m.
  std::array<std::uint64_t, max_child_shapes> sets{};
};
extern const ShapeTable shape_table;

/// Third power of the mean ratio of a child of a cell whose edges are straight. `squared`: the cell's squared edges.
/// `scale`: `cube_of_shape` times its volume squared, with the sign of the volume. Local.
double cubed_ratio(int shape, const std::array<double, 6>& squared, double scale);

/// The same of all shapes whose midpoints lie on edges of a set, into `ratio[shape]`; others are left as they are.
/// Returns the sets of marks, as in `ShapeTable::sets`, that may have a child below `limit`. Local.
std::uint64_t measure_child_shapes(EdgeMask edges, const std::array<double, 6>& squared, double scale, double limit,
                                   std::array<double, max_child_shapes>& ratio);

}  // namespace pamr::refine
