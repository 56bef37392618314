// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solvers/dsmc/gas/gas.hpp"

/// Kinetic theory: what is known of a flow before it is computed. Source: G. A. Bird, Molecular Gas Dynamics and the
/// Direct Simulation of Gas Flows, 1994, chapters 4 and 7.
namespace pamr::dsmc {

/// exp(-s^2) + sqrt(pi) s (1 + erf s): the flux through a plane towards which the gas moves with speed ratio s, divided
/// by that of the gas at rest.
double flux_factor(double s);

/// Molecules per area and time through a plane: number density n, temperature t, speed `normal` towards the plane.
double molecular_flux(double n, double t, double mass, double normal);

double most_probable_speed(double t, double mass);  ///< sqrt(2 k T / m)

/// Transport of variable hard spheres of one species at number density n and temperature t, SI units.
double viscosity(const Species& species, double t);
double mean_free_path(const Species& species, double n, double t);
double collision_frequency(const Species& species, double n, double t);  ///< of one molecule, 1/s

/// The mixture's mean molecule, for mean free path and collision frequency.
Species mean_species(const Gas& gas);

}  // namespace pamr::dsmc
