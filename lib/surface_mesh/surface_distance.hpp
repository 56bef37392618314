// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::surface_mesh {

/// A point that is too far, or in a part of a triangle of which nothing is proved.
struct FarPoint {
  geometry::Vec3 point;
  int from = -1, to = -1;  ///< its triangle, and the nearest one of the other surface
};

/// Largest distance of the points of a surface, triangles included, from another one: between two bounds.
struct SurfaceDistance {
  double at_least = 0;   ///< the distance of `where`
  double at_most = 0;    ///< no point of any triangle is farther
  geometry::Vec3 where;  ///< the farthest point that was found
  /// If `enough` was given: points farther than that or not proved to be nearer, at least one of each triangle that has
  /// such points. None if and only if `at_most` is no more than `enough`.
  std::vector<FarPoint> far;
};

struct DistanceOptions {
  double enough = 0;        ///< ends when `at_most` is no more than that, length unit
  double precision = 0.02;  ///< or than `at_least` and this part of it
  Exact<std::int64_t> max_queries =
      2'000'000;  ///< or after so many nearest points beyond those of the points of `from`
};

/// One-sided Hausdorff distance from the triangles of `from` to those of `to`. Triangles with an upper bound that is
/// too large are split where the nearest triangle changes, the worst first. Local, serial; one nearest point a
/// microsecond, 350 bytes a triangle of `to`. Pre: both have triangles. Source of the bound: M. Tang, M. Lee, Y. J.
/// Kim, Interactive Hausdorff distance computation for general polygonal models, 2009.
SurfaceDistance distance_from_to(const geometry::Triangulation& from, const geometry::Triangulation& to,
                                 const DistanceOptions& options = {});

}  // namespace pamr::surface_mesh
