// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "solvers/poisson_boltzmann/fem/state.hpp"
#include "solvers/poisson_boltzmann/goals/cubic_correction.hpp"
#include "solvers/poisson_boltzmann/goals/functionals.hpp"
#include "solvers/poisson_boltzmann/goals/volume_force.hpp"

/// What the error of a functional needs on cells of second order. Derivatives are by the coefficients of all functions
/// of third order (`CubicFunctions`), nodes first; remainders are what the error of the gradient adds in second order.
namespace pamr::poisson_boltzmann {

/// As `volume_form_derivative`, open walls included. Collective: one exchange.
std::vector<double> quadratic_volume_form_derivative(const par::Comm& comm, const State& state,
                                                     std::span<const double> chi, std::uint64_t open_walls,
                                                     const Component& component);
/// As `volume_form_remainder`, of each cell, open walls included. Local.
std::vector<double> quadratic_volume_form_remainder(const State& state, std::span<const double> chi,
                                                    std::uint64_t open_walls, const Component& component);

/// As `midplane_derivative`. Collective: one exchange.
std::vector<double> quadratic_midplane_derivative(const par::Comm& comm, const State& state, int patch);
/// As `midplane_remainder`, of each cell. Local.
std::vector<double> quadratic_midplane_remainder(const State& state, int patch);

/// The part of the energy from charges of walls and from the far field: it is stationary but for them. Collective: one
/// exchange.
std::vector<double> quadratic_energy_derivative(const par::Comm& comm, const State& state);

/// Derivative of the charge of the sites that the goal counts, with the other sign. Collective: one exchange.
std::vector<double> quadratic_charge_derivative(const par::Comm& comm, const State& state, const GoalFunctional& goal);
/// The square of the error in that charge, of each cell. Local.
std::vector<double> quadratic_charge_remainder(const State& state, const GoalFunctional& goal);

/// As `shape_error`, for what curved faces miss of their surfaces, with the gradients of third order. What is left is
/// added to `dual.rest`: the errors of these gradients, the square of the distance times the wave number of the gap,
/// and `charge_at_edges`. Collective: an exact sum.
double quadratic_shape_error(const par::Comm& comm, const State& state, const GoalFunctional& functional,
                             CubicGoalError& dual);

}  // namespace pamr::poisson_boltzmann
