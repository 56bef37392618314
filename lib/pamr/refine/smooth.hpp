// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/movable.hpp"
#include "pamr/refine/number.hpp"

namespace pamr::refine {

/// Largest displacement of a boundary node relative to its edge under which the inner nodes need not follow.
inline constexpr double gentle_ratio = 0.02;

/// Spreads the displacement of the boundary nodes into this level's inner nodes near them (within three cells of one
/// that moves by 2 % of its edge or more), so that the cells behind a curved wall follow it: order-free (Jacobi)
/// averaging over the cells at a node, old nodes fixed, sums in 64-bit fixed point so that neither order nor ranks
/// change a bit. New nodes within a patch on a plane follow in the plane. Appends the nodes that move to `movables`.
/// The number of sweeps depends on the largest displacement relative to its edge: none under 2 %, 10 up to 10 %, 30
/// beyond; it is returned. Collective: one neighbor exchange a sweep over the nodes of `shared` (of the refined mesh).
double smooth_displacement(const par::Comm& comm, const mesh::DistMesh& fine, const par::Pattern& shared,
                           const geometry::SurfaceSet& surfaces, const Numbering& numbering, LocalId n_old_nodes,
                           std::vector<Movable>& movables);

}  // namespace pamr::refine
