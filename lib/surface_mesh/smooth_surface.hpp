// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::surface_mesh {

struct SmoothOptions {
  Exact<int> n_steps = 5;
  double max_move = 0;        ///< a point moves no farther along its normal, length unit; 0: no bound
  double feature_angle = 40;  ///< degrees between two triangles, more is a sharp edge, whose points stay
};

struct Smoothed {
  geometry::Triangulation surface;
  std::int64_t n_fixed = 0;  ///< points on sharp edges and at the ends of open surfaces and next to those
  double worst_move = 0, mean_move = 0;
};

/// Moves points to even out noise: at each step towards the mean of their neighbors and then back by a little more, so
/// that planes stay planes and round bodies keep their size. With OpenMesh's smoothers. Local, serial; O(n) a step.
/// Pre: the surface is valid, closed or not. Source: G. Taubin, A signal processing approach to fair surface design,
/// 1995.
Smoothed smooth(const geometry::Triangulation& surface, const SmoothOptions& options);

}  // namespace pamr::surface_mesh
