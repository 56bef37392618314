// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace pamr::poisson_boltzmann {

/// One kind of ions of a solution.
struct Ion {
  int charge = 0;            ///< elementary charges, with sign
  double concentration = 0;  ///< far from all bodies: mol/m^3, or in each formula unit of one salt
};

/// Solution of one salt whose two ions carry +Z and -Z elementary charges, in equal numbers, or of any kinds of ions.
struct Electrolyte {
  std::string salt = "1:1";
  int valence = 1;                     ///< Z; 1 where there are `ions`
  double temperature = 298.15;         ///< K
  double permittivity = 78.5;          ///< relative to the vacuum
  std::optional<double> debye_length;  ///< 1/kappa, m; nothing: the case is stated in Debye lengths only
  std::vector<Ion> ions = {};          ///< whose charges add up to 0; empty for a Z:Z salt
  std::optional<double> ph = {};       ///< far from all bodies
};

/// What one dimensionless unit is worth. Lengths are scaled with kappa, potentials with Z e / kT.
struct Units {
  double potential = 0;                  ///< kT / Ze, V
  double force = 0;                      ///< eps eps0 (kT/Ze)^2, N; holds no length
  std::optional<double> length;          ///< 1/kappa, m
  std::optional<double> charge_density;  ///< eps eps0 kappa kT/Ze, C/m^2
  std::optional<double> charge;          ///< eps eps0 (kT/Ze) / kappa, C
  std::optional<double> site_density;    ///< `charge_density` in elementary charges on a square nanometer
  std::optional<double> energy;          ///< force / kappa, J
  std::optional<double> concentration;   ///< of the salt, mol/m^3; with `ions` the factor of theirs
};

/// The units of an electrolyte; those that hold a length need its Debye length.
Units units_of(const Electrolyte& electrolyte);

/// Debye length of a salt of `concentration` mol/m^3: kappa^2 = 2 n Z^2 e^2 / (eps eps0 kT), or with `ions` the sum of
/// n z^2 in place of 2 n Z^2. Meters.
double debye_length(const Electrolyte& electrolyte, double concentration);

}  // namespace pamr::poisson_boltzmann
