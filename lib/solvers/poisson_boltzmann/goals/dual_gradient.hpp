// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solvers/poisson_boltzmann/goals/error_estimate.hpp"
#include "solvers/poisson_boltzmann/goals/functionals.hpp"

namespace pamr::poisson_boltzmann {

/// Gradients of the dual solution w (n_nodes) of first order. That of a force or torque is rough where its cut-off
/// function chi falls, within a few cells: with the direction d, or rotation, of the component
///
///     w = w0 - chi d . grad psi,
///
/// where w0 solves the linearized equation without a source, as d . grad psi does. chi is a function of the mesh, which
/// is known. So what is recovered is grad w + (d . grad psi) grad chi; means of grad w itself would round chi off, and
/// that would be taken for an error of w. Collective: the exchanges of `recover`.
DualGradient dual_gradient(const par::Comm& comm, const State& state, const GoalFunctional& functional,
                           std::span<const double> w);

}  // namespace pamr::poisson_boltzmann
