// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/vec3.hpp"

namespace pamr::meshing {

/// A place on a closed surface and how thick the body is behind it.
struct Thickness {
  geometry::Vec3 point;
  /// Length of the way in, against the normal, to a part of the surface that is parallel within 15 degrees.
  double thickness = 0;
  double area = 0;  ///< of the surface for which the place stands
};

/// How a closed surface is sampled.
struct ThicknessOptions {
  double spacing = 0;              ///< one place for each square of it, length unit
  double most = 0;                 ///< thickness where the body is as thick as that, or thicker, length unit
  Exact<int> max_places = 20'000;  ///< then farther apart
};

/// Thicknesses at places on triangles that lie on the surface, or near it, counter-clockwise seen from outside. To a
/// hundredth of `most`. Places in the order of the triangles; the same bits for the same triangles. Local. Cost: of
/// some 20 signed distances a place.
std::vector<Thickness> thicknesses(const geometry::Surface& surface,
                                   std::span<const std::array<geometry::Vec3, 3>> triangles,
                                   const ThicknessOptions& options);

}  // namespace pamr::meshing
