// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::check {

/// The smallest of `mesh::worst_uniform_shape` over the base cells of a mesh: its regular cells, the cells of broken families, and the
/// parents of whole closure families; without those that a map of level 0 bends (`curved::level0_shapes`). 1 without
/// cells.
///
/// It is that of the roots, too, the ancestors that nothing is known to come before: among the known descendants of a
/// root there is always one that was a corner child throughout, and has its shape.
/// Collective: one reduction. O(cells).
double worst_uniform_shape(const par::Comm& comm, const mesh::DistMesh& mesh);

struct ShapeBound {
  double of_uniform_levels = 0;  ///< `worst_uniform_shape`
  /// Smallest mean ratio of all cells of all levels that refinements with a shape floor can make of a mesh, where cells
  /// are straight: closure cells are not worse than both the floor and a child of 1:8, or are there already.
  /// (Where diagonals are equal, this holds as long as the coordinates' rounding does not make them differ by 2^-40.)
  double of_all_levels = 0;
};

/// Collective: two reductions. O(cells).
ShapeBound shape_bound(const par::Comm& comm, const mesh::DistMesh& mesh, double shape_floor);

}  // namespace pamr::check
