// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "pamr/base/types.hpp"
#include "pamr/curved/bulge_energy.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/mesh/worst_place.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::curved {

/// The share of the curved walls in the Jacobian of the map at the sample points of its bent cells, by differences of the
/// residual. The bulges of edges that lie in no curved wall do not change it. Local. Cost: some 0.03 ms for each cell at a
/// wall of a CAD file.
SampledWalls sample_walls(const mesh::Level0Map& map);

/// Smallest mean ratio of a bent cell and of the eight cells that it is split into. Local. Cost: some microseconds.
double smallest_child(const mesh::Level0Map& map, LocalId cell);

/// Smallest mean ratio of the Jacobian of the map at `sample_points` of all bent cells. `walls`: of the map. Collective.
mesh::WorstPlace sampled_jacobian(const par::Comm& comm, const mesh::Level0Map& map, const SampledWalls& walls);

/// The shapes that a map of level 0 makes, before anything is split; the same on any number of ranks.
struct Level0Shapes {
  static constexpr int n_levels = 3;  ///< that are looked at

  /// Proved of the quadratic part of the map all over the bent cells (`geometry::bound_map`): no smaller is the
  /// Jacobian determinant, as a share of the straight cell's, and the mean ratio of the Jacobian (-1: not proved
  /// positive). The places lie where they are hardly larger. What curved walls add beyond is not in it.
  mesh::WorstPlace determinant, mean_ratio;
  mesh::WorstPlace sampled;  ///< `sampled_jacobian`
  /// Smallest mean ratio of the bent cells and of all cells that splitting them into eight gives, by level, with every
  /// node where the map puts it, walls included.
  std::array<double, n_levels + 1> split{1, 1, 1, 1};
  /// The same at any level, not proved: the smallest, over bent cells, of these, of what they come to if each level
  /// loses half of what the one before lost, and of what small cells at `sample_points` are split into.
  mesh::WorstPlace all_splits;
};

/// `walls`: of the map. Collective: some thirty reductions. Cost: about 0.05 ms for each bent cell, whatever the mesh has
/// become. Source: docs/coarse-walls.md.
Level0Shapes level0_shapes(const par::Comm& comm, const mesh::Level0Map& map, const SampledWalls& walls);
/// Samples the walls first. Collective.
inline Level0Shapes level0_shapes(const par::Comm& comm, const mesh::Level0Map& map) {
  return level0_shapes(comm, map, sample_walls(map));
}

}  // namespace pamr::curved
