// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solvers/poisson_boltzmann/goals/cubic_correction.hpp"
#include "solvers/poisson_boltzmann/goals/functionals.hpp"

namespace pamr::poisson_boltzmann {

/// Error of a goal, on the meshed part, from replacing curved surfaces by flat faces: to first order in the distance
/// between them, with a bound of the rest.
struct ShapeError {
  double correction = 0;
  double rest = 0;  ///< the square of the distance, and what recovered gradients in place of those used would change
};
struct DualGradients {
  std::span<const double> w;                            ///< n_nodes
  std::span<const geometry::Vec3> of_cells, recovered;  ///< n_cells, n_nodes
};
/// By shape_change.hpp. 0 where the mesh knows no curved surface. Collective: three exact sums.
ShapeError shape_error(const par::Comm& comm, const State& state, const GoalFunctional& functional,
                       const DualGradients& dual);

/// The correction of second order, for what curved faces miss of their surfaces, with the gradients of third order. What
/// is left is added to `dual.rest`: the errors of these gradients, the square of the distance times the wave number of
/// the gap, and `charge_at_edges`. Collective: an exact sum.
double shape_error(const par::Comm& comm, const State& state, const GoalFunctional& functional, CubicGoalError& dual);

}  // namespace pamr::poisson_boltzmann
