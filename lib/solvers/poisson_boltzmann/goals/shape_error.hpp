// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solvers/poisson_boltzmann/goals/functionals.hpp"

namespace pamr::poisson_boltzmann {

/// What a goal misses because flat faces stand in for the curved surfaces of patches of given potential, to first order
/// in the distance between them: the derivative of the functional by the shape (J. Hadamard, 1908), with the dual
/// solution w, of gradient `gradient` on the cells, on the meshed part. 0 where the mesh knows no curved surface.
/// Collective: an exact sum.
double shape_error(const par::Comm& comm, const State& state, const GoalFunctional& functional,
                   std::span<const geometry::Vec3> gradient);

}  // namespace pamr::poisson_boltzmann
