// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "pamr/geometry/box.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/geometry/vec3.hpp"

namespace pamr::order {

/// Place of a point of the grid of 2^21 cubes a side along Hilbert's curve: 63 bits. Local; about 10 ns.
/// Source: J. Skilling, "Programming the Hilbert curve", AIP Conf. Proc. 707 (2004), whose bit operations are tabled
/// here for three levels at a time.
std::uint64_t hilbert_key(std::array<std::uint32_t, 3> grid_point);

/// The grid laid over a box: cubes as large as its longest side needs, from its low corner on.
class CurveGrid {
 public:
  explicit CurveGrid(const geometry::Box& box);

  /// Place of a point along the curve. Points outside the box and those that are not finite get some place.
  std::uint64_t key(geometry::Vec3 point) const;

 private:
  geometry::Vec3 low_;
  double scale_ = 0;
};

/// Where the curve puts a cell.
inline std::uint64_t key_of(const CurveGrid& grid, const geometry::TetPoints& p) {
  return grid.key(geometry::centroid(p));
}

}  // namespace pamr::order
