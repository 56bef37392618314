// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

namespace pamr::poisson_boltzmann {

/// Solution of one salt whose two ions carry +Z and -Z elementary charges, in equal numbers.
struct Electrolyte {
  std::string salt = "1:1";
  int valence = 1;                     ///< Z
  double temperature = 298.15;         ///< K
  double permittivity = 78.5;          ///< relative to the vacuum
  std::optional<double> debye_length;  ///< 1/kappa, m; nothing: the case is stated in Debye lengths only
};

/// What one dimensionless unit is worth. Lengths are scaled with kappa, potentials with Z e / kT.
struct Units {
  double potential = 0;                  ///< kT / Ze, V
  double force = 0;                      ///< eps eps0 (kT/Ze)^2, N; holds no length
  std::optional<double> length;          ///< 1/kappa, m
  std::optional<double> charge_density;  ///< eps eps0 kappa kT/Ze, C/m^2
  std::optional<double> charge;          ///< eps eps0 (kT/Ze) / kappa, C
  std::optional<double> energy;          ///< force / kappa, J
  std::optional<double> concentration;   ///< of the salt, mol/m^3
};

/// The units of an electrolyte; those that hold a length need its Debye length.
Units units_of(const Electrolyte& electrolyte);

/// Debye length of a Z:Z salt of `concentration` mol/m^3: kappa^2 = 2 n Z^2 e^2 / (eps eps0 kT). Meters.
double debye_length(const Electrolyte& electrolyte, double concentration);

}  // namespace pamr::poisson_boltzmann
