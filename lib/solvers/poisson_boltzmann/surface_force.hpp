// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solvers/poisson_boltzmann/state.hpp"

namespace pamr::poisson_boltzmann {

/// Charge of each patch and forces on it, dimensionless, on full bodies; less what the plate profile alone exerts where
/// it is split off. A force that does not exist for a patch is left out.
struct PatchResult {
  std::string name;
  double symmetry_factor = 1;
  double area = 0;                                 ///< meshed, squared Debye lengths
  double charge = 0;                               ///< by nodal reactions; full body
  double charge_density = 0;                       ///< charge of the meshed part over its area
  geometry::Vec3 surface;                          ///< stress of the raw gradient over the surface, after Dyshlovenko
  geometry::Vec3 surface_recovered;                ///< the same with the recovered gradient
  std::optional<geometry::Vec3> surface_reaction;  ///< the same with the nodal charges, where u is given
  std::optional<geometry::Vec3> volume;            ///< with the cut-off function around a sphere
  std::optional<geometry::Vec3> midplane;          ///< through the mirror between two spheres
  double inner = 0, outer = 0;                     ///< of the cut-off function
};

/// Charges and surface forms of all patches; `volume` and `midplane` are left empty. Collective: exact sums.
std::vector<PatchResult> surface_results(const par::Comm& comm, const State& state);

}  // namespace pamr::poisson_boltzmann
