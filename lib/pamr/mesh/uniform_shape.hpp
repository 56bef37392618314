// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "pamr/geometry/tet_shape.hpp"

namespace pamr::mesh {

/// Smallest mean ratio among a straight cell and all cells that come of it by splitting into eight, again and again.
///
/// A corner child has the shape of its parent, and the four cells at the inner diagonal have two shapes between them.
/// So the shapes are followed from cell to inner cells until none is new; there are few, because the diagonal is the
/// shortest. Source: H. Kröger, T. Preusser, Numer. Math. 109 (2008), 435-457 (the shortest interior edge gives
/// finitely many shapes). Where two diagonals are equal to rounding, the one with the better worst cell is followed, as
/// refinement does; where that is equal too, or rounding could decide either way, both are.
/// Accurate to about 1e-8. 0 for a cell that is flat, inverted or not finite. `known`: that of other cells; the smaller of
/// both is returned, and a cell that cannot have a smaller one need not be followed. Local.
double worst_uniform_shape(const geometry::TetPoints& corner, double known = std::numeric_limits<double>::max());

}  // namespace pamr::mesh
