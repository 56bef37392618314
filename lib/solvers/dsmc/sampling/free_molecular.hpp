// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/gas/stream.hpp"
#include "solvers/dsmc/kernel/boundary.hpp"
#include "solvers/dsmc/sampling/loads.hpp"

namespace pamr::dsmc {

/// Free-molecular flow about a convex body that is alone in a stream: every molecule that reaches a face comes straight
/// from the stream, and the face has its own kind of wall. `wall`: one condition for each patch; faces of patches that
/// are no walls have no loads. Walls that move do so in their own planes (`leaves_its_plane`). Local; closed forms,
/// except for the pressure of the molecules that leave a wall of kind cll: one integral, to better than a millionth of
/// the pressure of a face that looks into the stream.
/// Source: G. A. Bird, Molecular Gas Dynamics and the Direct Simulation of Gas Flows, 1994, section 7.6 (Maxwell's
/// walls); R. G. Lord, Phys. Fluids A 3 (1991), whose kernel `reflect` draws from.
SurfaceLaw free_molecular_law(const Gas& gas, const Stream& stream, std::vector<BoundaryCondition> wall);

/// Whether a wall's velocity carries it through this face, by more than `allowed` of it. Local.
bool leaves_its_plane(const BoundaryCondition& wall, Vec3 normal, double allowed);

}  // namespace pamr::dsmc
