// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "solvers/poisson_boltzmann/fem/state.hpp"
#include "solvers/poisson_boltzmann/goals/electrodes.hpp"
#include "solvers/poisson_boltzmann/goals/layer.hpp"

namespace pamr::poisson_boltzmann {

/// Charge of each patch or body and forces on it, dimensionless, on full bodies; less what the plate profile alone
/// exerts where it is split off. What does not exist or means nothing is left out, with the reason.
struct PatchResult {
  std::string name;
  const Electrode* electrode = nullptr;  ///< null for patches without a charge or a potential
  double symmetry_factor = 1;
  double area = 0;                                  ///< meshed, squared Debye lengths
  Layer layer;                                      ///< the worst of its patches
  std::optional<double> charge;                     ///< by nodal reactions; full body
  std::optional<double> charge_density;             ///< charge of the meshed part over its area
  double mean_potential = 0;                        ///< over its area
  std::optional<geometry::Vec3> surface;            ///< stress of the raw gradient over the surface, after Dyshlovenko
  std::optional<geometry::Vec3> surface_recovered;  ///< the same with the recovered gradient
  std::optional<geometry::Vec3> surface_reaction;   ///< the same with the nodal charges, where u is given
  std::optional<geometry::Vec3> volume;             ///< with a cut-off function around it
  std::optional<geometry::Vec3> torque;             ///< with the same function, about the center of the electrode
  geometry::Vec3 through_walls;                     ///< part of `volume` through walls that meet it
  std::string no_volume;                            ///< why it has no volume form
  std::optional<geometry::Vec3> midplane;           ///< through the mirror between two bodies
  double inner = 0, outer = 0;                      ///< of the cut-off function around a sphere, where stated
};

/// dpsi/dn out of the liquid where the condition gives it, and the part of the profile that is split off elsewhere.
/// Local.
double outward_slope(const Problem& problem, const Boundary& boundary, const PlacedFacePoint& point, double u,
                     double psi0);

/// Charges and surface forms of all patches of the mesh and of the bodies of several patches, in this order; the other
/// forms are left empty. Refers to `electrodes`. Collective: exact sums.
std::vector<PatchResult> surface_results(const par::Comm& comm, const State& state,
                                         std::span<const Electrode> electrodes, const Layers& layers);

}  // namespace pamr::poisson_boltzmann
