// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/exact.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::assemble {

/// The unit cube as n x n x n cubes, x fastest, each cut into the 6 tetrahedra of Kuhn: one for each order of the axes
/// in which the steps lead from the cube's corner (0,0,0) to its corner (1,1,1). Cell 6c + p is tetrahedron p of cube
/// c, node i + (n+1)(j + (n+1)k) lies at (i/n, j/n, k/n). Patches `xmin xmax ymin ymax zmin zmax`, in this order, each
/// tied to the plane of its name. Neighbors are given; every rank holds the canonical block of the cells and of the
/// nodes. Local, though it asks `comm` for rank and size; each rank makes its own block. Throws `Error` unless 1 <= n
/// <= 10^5. Cost: O(block). Source: H. W. Kuhn, "Some combinatorial lemmas in topology", IBM J. Res. Dev. 4 (1960).
mesh::BlockMesh kuhn_cube(const par::Comm& comm, Exact<int> n);

}  // namespace pamr::assemble
