// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pamr/check/metrics.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::check {

/// Shapes of the boundary triangles of one patch, and how far they are off its surface.
struct TriangleReport {
  /// `mean_ratio` 4 sqrt(3) A / sum of squared edges, `aspect_ratio` longest edge / (2 sqrt(3) r_in), 1 is best;
  /// `min_angle`, `max_angle` of a triangle, degrees, 60 is best.
  std::vector<MetricReport> metrics;
  /// Distance of the triangles' middles from the surface, length unit: mean by area, and largest. 0 without a surface.
  double mean_distance = 0, worst_distance = 0;
};

/// The four metrics of one triangle, in that order; the worst values where it has no shape.
std::array<double, 4> triangle_metrics(const std::array<geometry::Vec3, 3>& corner);

/// Every patch of the mesh, in order. The same bits on every number of ranks. Collective: 10 reductions a patch. Cost:
/// one distance a triangle.
std::vector<TriangleReport> measure_triangles(const par::Comm& comm, const mesh::DistMesh& mesh);

}  // namespace pamr::check
