// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "solvers/poisson_boltzmann/fem/state.hpp"

namespace pamr::poisson_boltzmann {

/// psi - psi0 and psi0 at the nodes, with psi0 the profile of the plate whether it is split off or not.
struct Excess {
  std::vector<double> u, psi0;
};
/// Local.
Excess excess_of(const State& state);

/// Integral over a mirror, of the meshed part: |grad_t u|^2/2 + cosh(psi0 + u) - cosh psi0 - u sinh psi0. Positive:
/// what lies on this side of the mirror is pushed away from it. `excess` is that of the state. Collective: an exact
/// sum.
double midplane_force(const par::Comm& comm, const State& state, const Excess& excess, int patch);
/// Its derivative by the functions of `GoalSpace`. Collective: one exchange.
std::vector<double> midplane_derivative(const par::Comm& comm, const State& state, const Excess& excess, int patch);

/// n_cells: what the known error of the solution (`GoalSpace`) adds to it in second order, half of the integral of its
/// square within the mirror. Local.
std::vector<double> midplane_remainder(const State& state, const Excess& excess, int patch);

/// Integral of |grad psi|^2/2 + cosh psi - 1 over the mesh; `excess` less that of psi0 alone.
struct Energy {
  double total = 0, excess = 0;
};
/// Collective: exact sums.
Energy energy_of(const par::Comm& comm, const State& state, const Excess& excess);

}  // namespace pamr::poisson_boltzmann
