// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "meshing/meshing_domain.hpp"
#include "meshing/raw_mesh.hpp"

namespace pamr::meshing {

/// Takes away the cells that lie wholly behind the true boundary: four corners and two faces on one curved piece, the
/// middle of the edge inside them behind it too. Such a cell fills a dent that the boundary does not have (four points
/// of a convex wall, triangulated the wrong way); once new nodes are put on the wall nothing of it would be left.
/// Without it the two faces behind it are the boundary: the edge between them has flipped.
///
///        c                 c           seen from the gas: the faces abc, abd are replaced by acd, bcd, if cd is not
///       /|\               / \          a boundary edge already
///      a | b     ->      a---b
///       \|/               \ /
///        d                 d
///
/// Pre: boundary nodes lie on their pieces. Local, deterministic. Yields the number of cells taken away.
int peel(const Domain& domain, RawMesh& mesh);

}  // namespace pamr::meshing
