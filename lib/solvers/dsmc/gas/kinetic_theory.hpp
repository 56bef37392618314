// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solvers/dsmc/gas/gas.hpp"

/// Closed forms of kinetic theory: what a flow is expected to show before it is computed, and what tests compare with.
/// Source: G. A. Bird, Molecular Gas Dynamics and the Direct Simulation of Gas Flows, 1994, chapters 4 and 7.
namespace pamr::dsmc {

/// exp(-s^2) + sqrt(pi) s (1 + erf s): the flux through a plane towards which the gas moves with speed ratio s, over
/// that of the gas at rest.
double flux_factor(double s);

/// Molecules per area and time through a plane: number density n, temperature t, speed `normal` towards the plane.
double molecular_flux(double n, double t, double mass, double normal);

double most_probable_speed(double t, double mass);  ///< sqrt(2 k T / m)

/// Variable hard spheres, one species.
double viscosity(const Species& species, double t);
double mean_free_path(const Species& species, double n, double t);
double collision_frequency(const Species& species, double n, double t);  ///< of one molecule, 1/s

/// Mean free path of the mixture's mean molecule at number density n and temperature t, and collision frequency.
Species mean_species(const Gas& gas);

/// Pressure, shear stress and heat flux on a plate at angle theta (0 along the stream, pi/2 facing it) in
/// free-molecular flow with full diffuse accommodation: coefficients on rho V^2/2 (and rho V^3/2). `s`: speed ratio,
/// `t_ratio`: T_w/T.
struct PlateCoefficients {
  double pressure = 0, shear = 0, heat = 0;
};
PlateCoefficients free_molecular_plate(double s, double theta, double t_ratio, double rotational_degrees);

/// Drag of a sphere in free-molecular flow, diffuse, on its frontal area.
double free_molecular_sphere_drag(double s, double t_ratio);
/// Mean heat transfer of a sphere, on its frontal area and rho V^3/2.
double free_molecular_sphere_heat(double s, double t_ratio, double rotational_degrees);

/// Ratios across a normal shock at Mach number m.
struct ShockRatios {
  double density = 1, temperature = 1, pressure = 1;
};
ShockRatios normal_shock(double m, double gamma);

}  // namespace pamr::dsmc
