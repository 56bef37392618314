// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/certify.hpp"
#include "pamr/refine/movable.hpp"
#include "pamr/refine/number.hpp"

namespace pamr::refine {

/// Brings the nodes of `movables` to their targets with every cell exactly positive: the displacement is spread into
/// this level's inner nodes (`smooth_displacement`), this level's nodes near bad cells move to better places
/// (`untangle`), and where a cell would still turn over its nodes go back (`certify`). Collective.
Certificate settle(const par::Comm& comm, mesh::DistMesh& fine, const par::Pattern& shared,
                   const geometry::SurfaceSet& surfaces, const Numbering& numbering, LocalId n_old_nodes,
                   std::vector<Movable> movables, std::span<const LocalId> suspects);

}  // namespace pamr::refine
