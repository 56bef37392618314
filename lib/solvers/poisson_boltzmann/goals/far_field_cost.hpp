// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "solvers/poisson_boltzmann/goals/electrodes.hpp"
#include "solvers/poisson_boltzmann/goals/functionals.hpp"

namespace pamr::poisson_boltzmann {

/// Size of what walls with the far-field condition cost a functional, on the meshed part, with its dual solution `w`
/// (n_nodes): the integral over these walls of |w| times
///
///     |slope of the fit + alpha fit| + (k2 - k0) |u - fit| + 2 sinh(|u|/2) - |u|
///
/// The fit is the potential there as the sum of a monopole and a dipole of each sphere of the case (of each body where
/// it has none; flat walls make exp(-distance)), by least squares; so the first term is the flux that the condition lacks
/// to the next multipole. What the fit leaves is taken to fall off as the multipole after that, k0 and k2 being the rates
/// of monopole and quadrupole from the nearest of them. The last term is what a flat layer of the full equation has over
/// the linear one. The force through a mid-plane lacks the part beyond the walls as well, which passes the walls: the
/// integral of the stress on them is added. All of it is to first order in what the box changes; higher orders are taken
/// to be as large, as in `further_orders`, so it counts twice. 0 where no such wall is. Collective: a few exact sums.
double far_field_cost(const par::Comm& comm, const State& state, const std::vector<Electrode>& electrodes,
                      const Goal& goal, std::span<const double> w);

}  // namespace pamr::poisson_boltzmann
