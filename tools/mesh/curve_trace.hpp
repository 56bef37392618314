// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "mesh/solid.hpp"

namespace pamr::meshing {

/// The common curve of two surfaces of a solid.
class CommonCurve {
 public:
  CommonCurve(const Solid& solid, int a, int b) : solid_(&solid), a_(a), b_(b) {}

  /// Nearest point of the curve, by Newton steps; the point itself where there is none near by.
  struct Found {
    geometry::Vec3 point;
    bool is_on_curve = true;
  };
  Found project(geometry::Vec3 p) const;
  /// Square to both normals, not normalised: its length is the sine of the angle between the surfaces.
  geometry::Vec3 tangent(geometry::Vec3 p) const;

  struct Trace {
    std::vector<geometry::Vec3> point;  ///< the first one again at the end of a closed curve
    bool is_closed = false;
  };
  /// Every part of the curve near the given points of the surfaces, each once.
  std::vector<Trace> trace(const std::vector<geometry::Vec3>& starts) const;

  int a() const { return a_; }
  int b() const { return b_; }

 private:
  bool is_beyond(geometry::Vec3 p) const;
  Trace trace_from(geometry::Vec3 start) const;
  /// Goes on from the last point until the curve closes (true) or leaves the box or ends (false).
  bool follow(std::vector<geometry::Vec3>& points, double sense) const;

  const Solid* solid_;
  int a_, b_;
};

}  // namespace pamr::meshing
