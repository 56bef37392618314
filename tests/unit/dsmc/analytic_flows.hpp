// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <numbers>

#include "solvers/dsmc/gas/kinetic_theory.hpp"

/// Analytic solutions that flows are compared with.
/// Source: G. A. Bird, Molecular Gas Dynamics and the Direct Simulation of Gas Flows, 1994, chapter 7.
namespace pamr::test {

inline const double root_pi = std::sqrt(std::numbers::pi);

/// Pressure, shear stress and heat flux on a plate at angle theta (0 along the stream, pi/2 facing it) in
/// free-molecular flow: coefficients on rho V^2/2 (and rho V^3/2). `s`: speed ratio, `t_ratio`: T_w/T, `specular`: part
/// of the molecules that the wall reflects as a mirror, the others leave diffusely.
struct PlateCoefficients {
  double pressure = 0, shear = 0, heat = 0;
};
inline PlateCoefficients free_molecular_plate(double s, double theta, double t_ratio, double rotational_degrees,
                                              double specular = 0) {
  const double sn = s * std::sin(theta), chi = dsmc::flux_factor(sn), half = 0.5 * rotational_degrees;
  const double gauss = std::exp(-sn * sn), one_erf = 1 + std::erf(sn);
  PlateCoefficients c;
  c.pressure = ((1 + specular) * (sn * gauss / root_pi + (0.5 + sn * sn) * one_erf) +
                (1 - specular) * 0.5 * std::sqrt(t_ratio) * chi) /
               (s * s);
  c.shear = (1 - specular) * std::cos(theta) * chi / (s * root_pi);
  c.heat = (1 - specular) *
           ((s * s + 2) * gauss + root_pi * sn * (s * s + 2.5) * one_erf + half * chi - (2 + half) * t_ratio * chi) /
           (2 * root_pi * s * s * s);
  return c;
}

/// Drag of a sphere in free-molecular flow on its frontal area.
inline double free_molecular_sphere_drag(double s, double t_ratio, double specular = 0) {
  const double s2 = s * s;
  return (2 * s2 + 1) * std::exp(-s2) / (root_pi * s2 * s) + (4 * s2 * s2 + 4 * s2 - 1) * std::erf(s) / (2 * s2 * s2) +
         (1 - specular) * 2 * root_pi / (3 * s) * std::sqrt(t_ratio);
}

/// Mean heat transfer of a sphere, on its frontal area and rho V^3/2.
inline double free_molecular_sphere_heat(double s, double t_ratio, double rotational_degrees) {
  // Mean of the plate's coefficient over the sphere: integral over the polar angle, 2 pi R^2 sin over pi R^2.
  return boost::math::quadrature::gauss_kronrod<double, 61>::integrate(
      [&](double polar) {
        return free_molecular_plate(s, std::numbers::pi / 2 - polar, t_ratio, rotational_degrees).heat * 2 *
               std::sin(polar);
      },
      0.0, std::numbers::pi);
}

/// Ratios across a normal shock at Mach number m.
struct ShockRatios {
  double density = 1, temperature = 1, pressure = 1;
};
inline ShockRatios normal_shock(double m, double gamma) {
  const double m2 = m * m;
  ShockRatios r;
  r.density = (gamma + 1) * m2 / ((gamma - 1) * m2 + 2);
  r.pressure = 1 + 2 * gamma / (gamma + 1) * (m2 - 1);
  r.temperature = r.pressure / r.density;
  return r;
}

}  // namespace pamr::test
