// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "pamr/assemble/assemble.hpp"

namespace pamr::test {

/// A small random mesh (about 10 to 200 cells), whole in one block, cells, nodes and corners in random order: the
/// Delaunay tetrahedra of random points by CGAL. By seed: points with some distance in a box, in and on a ball, in a
/// flat box, on a lattice (so that edges tie) or near a body-centered one (so that cells are good); the boundary is the
/// convex hull, or cells were taken away from it, or only the flat ones were. Three patches, a face's drawn by lot. All
/// cells exactly positive and of mean ratio above 1e-6; the boundary touches itself in no edge (in nodes it may). The
/// same for equal seeds. `whole_numbers`: coordinates are multiples of 2^-18, so that several levels of midpoints are
/// exact. Serial.
mesh::BlockMesh random_delaunay(std::uint64_t seed, bool whole_numbers = false);

/// The same kind of mesh, its boundary nodes on the unit sphere, the whole boundary in the patch `ball` that is tied to
/// that surface. Coarse: a new node may not find its way to the surface.
mesh::BlockMesh random_ball(std::uint64_t seed);

/// The same kind of mesh under a shallow dome: a block of edge 1 and about 250 cells whose upper side lies on a
/// sphere of radius 4 (its patch `dome` is tied to the surface of that name), all else in the patch `wall`, free.
mesh::BlockMesh random_dome(std::uint64_t seed);

}  // namespace pamr::test
