// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/units.hpp"

#include <cmath>

namespace pamr::poisson_boltzmann {

namespace {

// CODATA 2018.
constexpr double elementary_charge = 1.602176634e-19;     // C
constexpr double boltzmann = 1.380649e-23;                // J/K
constexpr double vacuum_permittivity = 8.8541878128e-12;  // F/m
constexpr double avogadro = 6.02214076e23;                // 1/mol

/// Sum of the squared charges of the ions of one formula unit: 2 Z^2, or with `ions` the sum of c z^2.
double charges_squared(const Electrolyte& e) {
  double sum = e.ions.empty() ? 2.0 * e.valence * e.valence : 0;
  for (const auto& ion : e.ions) sum += ion.concentration * ion.charge * ion.charge;
  return sum;
}

double thermal_potential(const Electrolyte& e) { return boltzmann * e.temperature / (e.valence * elementary_charge); }

}  // namespace

Units units_of(const Electrolyte& e) {
  Units units;
  const double permittivity = e.permittivity * vacuum_permittivity;
  units.potential = thermal_potential(e);
  units.force = permittivity * units.potential * units.potential;
  if (!e.debye_length) return units;
  const double length = *e.debye_length;
  units.length = length;
  units.charge_density = permittivity * units.potential / length;
  units.site_density = *units.charge_density / elementary_charge * 1e-18;
  units.charge = permittivity * units.potential * length;
  units.energy = units.force * length;
  const double squared = charges_squared(e) * elementary_charge * elementary_charge;
  units.concentration = permittivity * boltzmann * e.temperature / (squared * length * length) / avogadro;
  return units;
}

double debye_length(const Electrolyte& e, double concentration) {
  return std::sqrt(e.permittivity * vacuum_permittivity * boltzmann * e.temperature /
                   (charges_squared(e) * concentration * avogadro * elementary_charge * elementary_charge));
}

}  // namespace pamr::poisson_boltzmann
