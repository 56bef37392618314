// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::check {

/// The shapes of cells that have a face in a patch with a surface.
struct WallShapes {
  double smallest = 1;       ///< mean ratio
  geometry::Vec3 where;      ///< centroid of that cell; of several the first by coordinates
  std::int64_t n_below = 0;  ///< cells under the limit that was asked for
  bool operator==(const WallShapes&) const = default;
};

/// Of no cell where no patch lies on a curved surface. The same on any number of ranks. Collective: six reductions.
/// O(cells).
WallShapes wall_shapes(const par::Comm& comm, const mesh::DistMesh& mesh, double limit);

/// Splitting into eight makes no straight cell worse than 3/4 of its mean ratio: under 0.7 of the smallest one before
/// (and under 0.2, where refinement moves nodes to better shapes), nodes on their way to curved walls did it.
double limit_of_lost_shape(const WallShapes& before);

}  // namespace pamr::check
