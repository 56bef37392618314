// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "solvers/poisson_boltzmann/fem/solve.hpp"
#include "solvers/poisson_boltzmann/goals/midplane_force.hpp"
#include "solvers/poisson_boltzmann/goals/surface_force.hpp"
#include "solvers/poisson_boltzmann/goals/volume_force.hpp"

namespace pamr::poisson_boltzmann {

/// The functional of a goal and what its dual system needs.
struct GoalFunctional {
  Goal goal;
  std::optional<double> value;  ///< on full bodies; nothing where the layer at the patch is not resolved at all
  double factor = 1;            ///< of the symmetry: what full bodies have over the meshed part
  double remainder = 0;         ///< what the error of the gradient adds in second order, on the meshed part
  std::vector<double> squares;  ///< n_cells, of second order: what `remainder` is the sum of; empty if it is 0
  double through_walls = 0;     ///< part of a force whose derivative `load` lacks
  /// The derivative by the functions of `GoalSpace`, those of the nodes first; of a charge with the other sign.
  std::vector<double> load;
  std::vector<double> fixed;  ///< n_nodes, or empty: the dual solution where u is given
  std::uint64_t counted = 0;  ///< bit p: the charge of the sites on patch p is part of the value

  /// Of a force or torque of first order: its cut-off function (n_nodes) and component; empty elsewhere.
  std::vector<double> cut_off;
  Component component;

  bool counts(int patch) const { return (counted >> static_cast<unsigned>(patch) & 1U) != 0; }
};

/// Charges, forces, torques and energy of a solution.
struct Functionals {
  std::vector<PatchResult> patches;  ///< of the mesh, then bodies of several patches
  Energy energy;
  std::string no_midplane;            ///< why no single body has the mid-plane force
  std::vector<GoalFunctional> goals;  ///< in the order of the case
};

/// Throws `Error` when the case has a goal that its bodies and mirrors do not have, or a mid-plane that is not flat: to
/// be called before the solution is computed. Collective: a few reductions.
void require_goals(const par::Comm& comm, const Problem& problem);

/// Refers to `electrodes`. Collective. Throws `Error` when a stated cut-off function has no room. Pre: `require_goals`.
Functionals find_functionals(const par::Comm& comm, const State& state, System& system,
                             const std::vector<Electrode>& electrodes, const Layers& layers);

}  // namespace pamr::poisson_boltzmann
