// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "solvers/poisson_boltzmann/goals/midplane_force.hpp"

namespace pamr::poisson_boltzmann {

/// Free energies of the meshed part, dimensionless as `Energy`, including the energy beyond walls of the far field as
/// the condition there estimates it. The force on a body is minus the derivative by its place: of the first while
/// potentials are held, of the second while charges are, of the third while all walls keep their conditions. Source: K.
/// A. Sharp, B. Honig, J. Phys. Chem. 94 (1990).
struct FreeEnergy {
  double fixed_potential = 0;  ///< minus the energy
  double fixed_charge = 0;     ///< that and the integral of charge times potential over all walls
  /// The same over walls of given charge only, with the free energy of sites in equilibrium with their protons, less
  /// that at no potential (`SiteCharge::integral`), in its place at theirs.
  double as_stated = 0;
};

/// Nothing for cases with a plate, whose own energy grows with the mesh, and for the manufactured solution. Collective:
/// an exact sum.
std::optional<FreeEnergy> free_energy_of(const par::Comm& comm, const State& state, const Energy& energy);

}  // namespace pamr::poisson_boltzmann
