// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "meshing/meshing_domain.hpp"
#include "meshing/raw_mesh.hpp"

namespace pamr::meshing {

/// Mends cells that lie between two regions: four corners and two faces on one piece between them.
///
/// - One that lies wholly behind the piece goes to the region there: the edge between its two faces flips, as in
///   `peel`.
/// - A flat one (of a small mean ratio: all corners in one plane, where Delaunay refinement leaves four nodes on a
///   circle) is flipped away: its edge inside goes, and the cells around that edge are made anew from the same nodes,
///   such that the poorest one is best; or it goes to the other side and is flipped away there, where that is better.
///
/// Pre: boundary nodes lie on their pieces. Local, deterministic. Yields the number of cells that were mended;
/// `improve` refuses poor ones that are left.
int flip_between(const Domain& domain, RawMesh& mesh);

}  // namespace pamr::meshing
