// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::check {

/// Smallest mean ratio among a straight cell and all cells that come of it by splitting into eight, again and again.
///
/// A corner child has the shape of its parent, and the four cells at the inner diagonal have two shapes between them.
/// So the shapes are followed from cell to inner cells until none is new; there are few, because the diagonal is the
/// shortest. Source: H. Kröger, T. Preusser, Numer. Math. 109 (2008), 435-457 (the shortest interior edge gives
/// finitely many shapes). Where two diagonals are equal to rounding, the one with the better worst cell is followed, as
/// refinement does; where that is equal too, or rounding could decide either way, both are.
/// Accurate to about 1e-8. 0 for a cell that is flat, inverted or not finite. Local.
double worst_uniform_shape(const geometry::TetPoints& corner);

/// The smallest of these over the base cells of a mesh: its regular cells, the cells of broken families, and the
/// parents of whole closure families.
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
