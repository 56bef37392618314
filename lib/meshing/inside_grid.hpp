// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "meshing/solid.hpp"

namespace pamr::meshing {

/// Knows of points deep in a solid that they are in it, without looking for the nearest triangles, of which there are
/// many equally near in the middle of a round body: a ball about each place of a grid reaches to the nearest surface.
/// Places are looked at when they are first asked for; what is answered depends on no earlier question. For one thread.
class InsideGrid {
 public:
  /// Pre: the distances from all surfaces are exact (`is_exact_for`).
  explicit InsideGrid(std::shared_ptr<const Solid> solid);

  /// CAD shapes by their triangles, and planes.
  static bool is_exact_for(const Solid& solid);

  /// True for points that are known to lie in the solid; false says nothing.
  bool holds(geometry::Vec3 point);

 private:
  static constexpr int n = 48;  ///< places along each side of the solid's box
  double radius_at(geometry::Vec3 place) const;

  std::shared_ptr<const Solid> solid_;
  std::vector<double> radius_;  ///< n x n x n; negative: not looked at, 0: nothing is known
};

}  // namespace pamr::meshing
