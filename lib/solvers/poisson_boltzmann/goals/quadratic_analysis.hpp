// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "solvers/poisson_boltzmann/fem/state.hpp"
#include "solvers/poisson_boltzmann/goals/error_estimate.hpp"
#include "solvers/poisson_boltzmann/goals/midplane_force.hpp"
#include "solvers/poisson_boltzmann/goals/volume_force.hpp"

/// What is computed from a solution of second order; the linear twins stand in the files of the same words.
namespace pamr::poisson_boltzmann {

/// Gradient at all nodes: the mean of those of the cells around each, weighted with their volumes or plain.
/// Collective: exchanges of shared nodes.
std::vector<geometry::Vec3> recover_quadratic(const par::Comm& comm, const Domain& domain, std::span<const double> u,
                                              Recovery recovery);

/// Errors of u and of its gradient against the manufactured solution. Collective: one reduction.
struct ManufacturedErrors {
  double l2 = 0, h1 = 0;
};
ManufacturedErrors quadratic_manufactured_errors(const par::Comm& comm, const Domain& domain,
                                                 std::span<const double> u);

/// As `volume_form`. Collective: exact sums.
VolumeForm quadratic_volume_form(const par::Comm& comm, const State& state, std::span<const double> chi,
                                 std::uint64_t open_walls, geometry::Vec3 center);

/// As `energy_of`. Collective: exact sums.
Energy quadratic_energy(const par::Comm& comm, const State& state);

/// As `midplane_force`. Collective: an exact sum.
double quadratic_midplane_force(const par::Comm& comm, const State& state, int patch);

/// dpsi/dn out of the liquid where the condition gives it, and the part of the profile that is split off elsewhere.
double outward_slope(const Problem& problem, const Boundary& boundary, const PlacedFacePoint& placed, double u);

/// Sums over one patch of the mesh.
struct QuadraticSurface {
  double area = 0, potential = 0;
  /// Of patches with given u the sum of the nodal reactions, a node of several counting to the one that decides it.
  double charge = 0;
  geometry::Vec3 raw, recovered;  ///< stress of both gradients over the patch
};
/// Collective: exact sums.
std::vector<QuadraticSurface> quadratic_surfaces(const par::Comm& comm, const State& state);

}  // namespace pamr::poisson_boltzmann
