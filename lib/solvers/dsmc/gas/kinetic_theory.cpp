// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/gas/kinetic_theory.hpp"

#include <cmath>
#include <numbers>

namespace pamr::dsmc {

namespace {
constexpr double pi = std::numbers::pi;
const double sqrt_pi = std::sqrt(pi);
}  // namespace

double flux_factor(double s) { return std::exp(-s * s) + sqrt_pi * s * (1 + std::erf(s)); }

double most_probable_speed(double t, double mass) { return std::sqrt(2 * boltzmann * t / mass); }

double molecular_flux(double n, double t, double mass, double normal) {
  const double c = most_probable_speed(t, mass);
  return n * c / (2 * sqrt_pi) * flux_factor(normal / c);
}

double viscosity(const Species& s, double t) {
  const double reference = 15 * std::sqrt(pi * s.mass * boltzmann * s.t_ref) /
                           (2 * pi * s.diameter * s.diameter * (5 - 2 * s.omega) * (7 - 2 * s.omega));
  return reference * std::pow(t / s.t_ref, s.omega);
}

double mean_free_path(const Species& s, double n, double t) {
  return 1 / (std::numbers::sqrt2 * pi * s.diameter * s.diameter * n * std::pow(s.t_ref / t, s.omega - 0.5));
}

double collision_frequency(const Species& s, double n, double t) {
  return 4 * s.diameter * s.diameter * n * std::sqrt(pi * boltzmann * s.t_ref / s.mass) *
         std::pow(t / s.t_ref, 1 - s.omega);
}

Species mean_species(const Gas& gas) {
  Species mean;
  mean.name = "mean";
  mean.omega = mean.t_ref = mean.alpha = 0;
  for (std::size_t i = 0; i < gas.species.size(); ++i) {
    const auto& s = gas.species[i];
    const double f = gas.fraction[i];
    mean.mass += f * s.mass;
    mean.diameter += f * s.diameter;
    mean.omega += f * s.omega;
    mean.t_ref += f * s.t_ref;
    mean.alpha += f * s.alpha;
  }
  return mean;
}

}  // namespace pamr::dsmc
