// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/source_term.hpp"

#include <cmath>

namespace pamr::poisson_boltzmann {

double SourceTerm::value(double u, double psi0) const {
  if (linear_) return u;
  const double psi = psi0 + u;
  if (std::abs(psi) > largest_argument) {
    const double end = std::copysign(largest_argument, psi);
    return std::sinh(end) + (psi - end) * std::cosh(end) - std::sinh(psi0);
  }
  if (psi0 == 0) return std::sinh(u);  // one function for two: where nothing is split off, everywhere
  return 2 * std::cosh(psi0 + u / 2) * std::sinh(u / 2);
}

double SourceTerm::slope(double u, double psi0) const {
  if (linear_) return 1;
  return std::cosh(std::min(std::abs(psi0 + u), largest_argument));
}

double SourceTerm::curvature(double u, double psi0) const {
  const double psi = psi0 + u;
  return linear_ || std::abs(psi) > largest_argument ? 0 : std::sinh(psi);
}

double SourceTerm::pressure(double u, double psi0) const {
  if (linear_) return u * (psi0 + u / 2);
  const double half = std::sinh(u / 2);
  return 2 * half * (psi0 == 0 ? half : std::sinh(psi0 + u / 2));
}

double SourceTerm::pressure_slope(double u, double psi0) const { return linear_ ? psi0 + u : std::sinh(psi0 + u); }

double SourceTerm::convex_rest(double u, double psi0) const {
  if (linear_) return u * u / 2;
  const double half = std::sinh(u / 2);
  const double cosh_rest = 2 * half * half;  // cosh u - 1
  const double u2 = u * u;
  const double sinh_rest = std::abs(u) < 1e-2 ? u * u2 / 6 * (1 + u2 / 20 * (1 + u2 / 42)) : std::sinh(u) - u;
  return std::cosh(psi0) * cosh_rest + std::sinh(psi0) * sinh_rest;
}

}  // namespace pamr::poisson_boltzmann
