// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/flow/setup.hpp"
#include "solvers/dsmc/run/flow_case.hpp"

namespace pamr::dsmc {

/// The patches of the gas with their conditions: `Setup::patch`, `patches` and `inner_wall`; needs its `unit`.
///
/// Every patch of the boundary needs a table of the case. A patch NAME inside the gas is open unless a table names it,
/// without a pattern, or a group of it: then it is a wall whose sides are the patches NAME:front and NAME:back, both of
/// the group NAME; a table may name a side. A patch that is on the boundary and inside keeps its name on the boundary.
/// Collective. Throws `Error` on every rank for patches without a table, tables without a patch, conditions inside that
/// are no walls, and sides of which the case does not tell which is the front.
void set_patches(const par::Comm& comm, const Case& c, const mesh::DistMesh& mesh, Setup& setup);

}  // namespace pamr::dsmc
