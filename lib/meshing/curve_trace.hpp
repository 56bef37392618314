// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "meshing/pieces.hpp"

namespace pamr::meshing {

/// The common curve of two surfaces of a solid, or of a smooth piece of the one and one of the other.
class CommonCurve {
 public:
  CommonCurve(const Solid& solid, const Pieces& pieces, std::array<int, 2> piece)
      : solid_(&solid),
        piece_(piece),
        a_(pieces.at(piece[0]).surface),
        b_(pieces.at(piece[1]).surface),
        shape_{pieces.at(piece[0]).shape, pieces.at(piece[1]).shape} {}

  /// Nearest point of the curve, by Newton steps; the point itself where there is none nearby.
  struct Found {
    geometry::Vec3 point;
    bool is_on_curve = true;
  };
  Found project(geometry::Vec3 p) const;
  /// Square to both normals, not normalized: its length is the sine of the angle between the surfaces.
  geometry::Vec3 tangent(geometry::Vec3 p) const;

  struct Trace {
    std::vector<geometry::Vec3> point;  ///< the first one again at the end of a closed curve
    bool is_closed = false;
  };
  /// Every part of the curve near the given points of the surfaces, each once. Where a piece ends, a part of the curve
  /// comes within 1e-6 of the solid's radius of its end.
  std::vector<Trace> trace(const std::vector<geometry::Vec3>& starts) const;

  std::array<int, 2> piece() const { return piece_; }
  int a() const { return a_; }  ///< the surface of the first piece
  int b() const { return b_; }
  const std::array<const geometry::Surface*, 2>& shape() const { return shape_; }

 private:
  bool is_beyond(geometry::Vec3 p) const;
  bool is_triangulated(geometry::Vec3 p) const;
  Trace trace_from(geometry::Vec3 start) const;
  /// Goes on from the last point until the curve closes (true) or leaves the box or ends (false).
  bool follow(std::vector<geometry::Vec3>& points, double sense) const;

  const Solid* solid_;
  std::array<int, 2> piece_;
  int a_, b_;
  std::array<const geometry::Surface*, 2> shape_;
};

}  // namespace pamr::meshing
