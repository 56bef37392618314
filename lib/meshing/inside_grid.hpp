// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "meshing/meshing_domain.hpp"
#include "meshing/solid.hpp"

namespace pamr::meshing {

/// Knows of points deep in a solid that they are in it, without looking for the nearest triangles, of which there are
/// many equally near in the middle of a round body: a ball about each place of a grid reaches to the nearest surface.
/// Places are looked at when they are first asked for; what is answered depends on no earlier question. For one thread.
class InsideGrid {
 public:
  /// `region`: of a point in the solid, where faces of one surface divide it, from 0 on; null: that of its sides. Pre:
  /// the distances from all surfaces are exact (`is_exact_for`).
  explicit InsideGrid(std::shared_ptr<const Solid> solid, std::function<int(geometry::Vec3)> region = nullptr);

  /// CAD shapes by their triangles, and planes.
  static bool is_exact_for(const Solid& solid);

  /// A ball in the solid that holds the point; that of the region -1 says nothing.
  Domain::Ball around(geometry::Vec3 point);
  /// The region of points that are known to lie in the solid; -1 says nothing.
  int region_at(geometry::Vec3 point) { return around(point).region; }
  bool holds(geometry::Vec3 point) { return region_at(point) >= 0; }

 private:
  static constexpr int n = 48;  ///< places along each side of the solid's box
  Domain::Ball ball_at(geometry::Vec3 place) const;

  std::shared_ptr<const Solid> solid_;
  std::function<int(geometry::Vec3)> region_;
  std::vector<Domain::Ball> ball_;  ///< n x n x n; radius negative: not looked at, 0: nothing is known
};

}  // namespace pamr::meshing
