// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/site_charge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pamr/base/error.hpp"

namespace pamr::poisson_boltzmann {

namespace {

/// ln(1 + exp(x)).
double softplus(double x) { return std::max(x, 0.0) + std::log1p(std::exp(-std::abs(x))); }

}  // namespace

double SiteCharge::charged_share(double psi) const {
  const double x = shift + rate * psi, decay = std::exp(-std::abs(x));
  return (x > 0 ? decay : 1) / (1 + decay);
}

double SiteCharge::slope(double psi) const {
  const double share = charged_share(psi);
  return -density * rate * share * (1 - share);
}

double SiteCharge::curvature(double psi) const {
  const double share = charged_share(psi);
  return density * rate * rate * share * (1 - share) * (1 - 2 * share);
}

double SiteCharge::integral(double psi) const {
  if (density == 0) return 0;
  return density / rate * (softplus(-shift) - softplus(-(shift + rate * psi)));
}

double SiteCharge::flat_wall_potential(const SourceTerm& term) const {
  double below = 0, above = term.potential_of_charge(density);
  for (int i = 0; i < 200 && below != above; ++i) {
    const double middle = (below + above) / 2;
    (term.flat_wall_slope(middle) < std::abs(value(middle)) ? below : above) = middle;
  }
  return above;
}

SiteCharge read_site_charge(const TomlTable& table, const Electrolyte& electrolyte) {
  const double sign = table.word("site", {"acid", "base"}) == "acid" ? -1 : 1;
  const auto unit = table.word_or("unit", "dimensionless", {"dimensionless", "C/m2", "1/nm2"});
  const auto units = units_of(electrolyte);
  const auto& of_unit = unit == "C/m2" ? units.charge_density : units.site_density;
  if (unit != "dimensionless" && !of_unit)
    throw Error(
        fmt::format("{}: expected debye_length or concentration in [electrolyte] for a density of sites in {}, found "
                    "none",
                    table.at("unit"), unit));
  if (!electrolyte.ph)
    throw Error(fmt::format("{}: expected pH in [electrolyte] for a pK, found none", table.at("pK")));
  const double density = table.number("value", {1e-50, 1e50}) / (unit == "dimensionless" ? 1 : *of_unit);
  const double pk = table.number("pK", {-100, 100});
  return {sign * density, sign * std::numbers::ln10 * (*electrolyte.ph - pk), sign / electrolyte.valence};
}

}  // namespace pamr::poisson_boltzmann
