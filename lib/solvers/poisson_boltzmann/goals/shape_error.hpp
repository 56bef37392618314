// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solvers/poisson_boltzmann/goals/cubic_correction.hpp"
#include "solvers/poisson_boltzmann/goals/error_estimate.hpp"
#include "solvers/poisson_boltzmann/goals/functionals.hpp"

namespace pamr::poisson_boltzmann {

/// Error of a goal, on the meshed part, from replacing curved surfaces by flat faces: to first order in the distance
/// between them, with a bound of the rest.
struct ShapeError {
  double correction = 0;
  double rest = 0;  ///< the square of the distance, and what recovered gradients in place of those used would change
};
/// By shape_change.hpp, with the dual solution w (n_nodes). 0 where the mesh knows no curved surface. Collective: three
/// exact sums.
ShapeError shape_error(const par::Comm& comm, const State& state, const GoalFunctional& functional,
                       std::span<const double> w, const DualGradient& dual);

/// The correction of second order, for what curved faces miss of their surfaces, with the gradients of third order.
/// Adds the errors that remain to `dual.rest`: those of these gradients, the square of the distance times the wave
/// number of the gap, and `charge_at_edges`. Collective: an exact sum.
double shape_error(const par::Comm& comm, const State& state, const GoalFunctional& functional, CubicGoalError& dual);

}  // namespace pamr::poisson_boltzmann
