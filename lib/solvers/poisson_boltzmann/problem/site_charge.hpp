// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/base/toml_table.hpp"
#include "solvers/poisson_boltzmann/problem/source_term.hpp"
#include "solvers/poisson_boltzmann/problem/units.hpp"

namespace pamr::poisson_boltzmann {

/// Charge density of a wall with one kind of sites that take up or give off a proton, as it follows from the potential
/// of the wall (charge regulation): with s = -1 of acid sites, which carry -e without their proton, and s = 1 of basic
/// ones, which carry e with it,
///
///     sigma(psi) = s N / (1 + 10^(s (pH - pK)) exp(s psi/Z)),
///
/// pH that of the liquid far away, psi/Z = e Psi/kT. Dimensionless. Its slope is never positive, so that the equation
/// keeps its only solution. Source: B. W. Ninham, V. A. Parsegian, J. Theor. Biol. 31 (1971); S. H. Behrens, D. G.
/// Grier, J. Chem. Phys. 115 (2001), without a Stern layer.
struct SiteCharge {
  double density = 0;  ///< s N: the charge density with all sites charged
  double shift = 0;    ///< s ln 10 (pH - pK)
  double rate = 0;     ///< s/Z

  double value(double psi) const { return density * charged_share(psi); }
  /// d value / dpsi, and the derivative of that.
  double slope(double psi) const;
  double curvature(double psi) const;
  /// Integral of `value` from 0 to psi: minus the free energy of the sites at psi, less that at 0.
  double integral(double psi) const;
  /// Share of the sites that carry their charge, 0 to 1.
  double charged_share(double psi) const;

  /// Potential of a flat wall of such sites alone in the liquid: where `value` is the charge that such a wall needs.
  double flat_wall_potential(const SourceTerm& term) const;
};

/// Reads `site`, `value`, `unit` and `pK` of a table of [boundary]. Throws `Error` for wrong values, and where the
/// electrolyte lacks a pH, or a Debye length for a density in units of length.
SiteCharge read_site_charge(const TomlTable& table, const Electrolyte& electrolyte);

}  // namespace pamr::poisson_boltzmann
