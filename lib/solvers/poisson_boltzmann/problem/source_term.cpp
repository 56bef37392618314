// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/source_term.hpp"

#include <algorithm>
#include <cmath>

namespace pamr::poisson_boltzmann {

namespace {

/// exp(x) - 1 - x without cancellation.
double exp_rest(double x) {
  if (std::abs(x) >= 1e-2) return std::expm1(x) - x;
  return x * x / 2 * (1 + x / 3 * (1 + x / 4 * (1 + x / 5 * (1 + x / 6 * (1 + x / 7)))));
}

}  // namespace

SourceTerm::SourceTerm(bool linear, const std::vector<Ion>& ions) : linear_(linear), largest_(largest_argument) {
  if (linear) return;
  double squares = 0, most = 1;
  for (const auto& ion : ions) {
    squares += ion.concentration * ion.charge * ion.charge;
    most = std::max(most, std::abs(static_cast<double>(ion.charge)));
  }
  for (const auto& ion : ions) part_.push_back({static_cast<double>(ion.charge), ion.concentration / squares});
  largest_ /= most;
}

double SourceTerm::value(double u, double psi0) const {
  if (linear_) return u;
  const double psi = psi0 + u;
  if (std::abs(psi) > largest_) {
    const double end = std::copysign(largest_, psi);
    if (!part_.empty()) return value(end - psi0, psi0) + (psi - end) * slope(end, 0);
    return std::sinh(end) + (psi - end) * std::cosh(end) - std::sinh(psi0);
  }
  if (!part_.empty()) return -sum([&](double z) { return z * std::exp(-z * psi0) * std::expm1(-z * u); });
  if (psi0 == 0) return std::sinh(u);  // one function for two: where nothing is split off, everywhere
  return 2 * std::cosh(psi0 + u / 2) * std::sinh(u / 2);
}

double SourceTerm::slope(double u, double psi0) const {
  if (linear_) return 1;
  const double psi = std::clamp(psi0 + u, -largest_, largest_);
  return part_.empty() ? std::cosh(psi) : sum([&](double z) { return z * z * std::exp(-z * psi); });
}

double SourceTerm::curvature(double u, double psi0) const {
  const double psi = psi0 + u;
  if (linear_ || std::abs(psi) > largest_) return 0;
  return part_.empty() ? std::sinh(psi) : -sum([&](double z) { return z * z * z * std::exp(-z * psi); });
}

double SourceTerm::pressure(double u, double psi0) const {
  if (linear_) return u * (psi0 + u / 2);
  if (!part_.empty()) return convex_rest(u, psi0) + u * pressure_slope(psi0, 0);
  const double half = std::sinh(u / 2);
  return 2 * half * (psi0 == 0 ? half : std::sinh(psi0 + u / 2));
}

double SourceTerm::pressure_slope(double u, double psi0) const {
  if (linear_) return psi0 + u;
  return part_.empty() ? std::sinh(psi0 + u) : -sum([&](double z) { return z * std::expm1(-z * (psi0 + u)); });
}

double SourceTerm::convex_rest(double u, double psi0) const {
  if (linear_) return u * u / 2;
  if (!part_.empty()) return sum([&](double z) { return std::exp(-z * psi0) * exp_rest(-z * u); });
  const double half = std::sinh(u / 2);
  const double cosh_rest = 2 * half * half;  // cosh u - 1
  const double u2 = u * u;
  const double sinh_rest = std::abs(u) < 1e-2 ? u * u2 / 6 * (1 + u2 / 20 * (1 + u2 / 42)) : std::sinh(u) - u;
  return std::cosh(psi0) * cosh_rest + std::sinh(psi0) * sinh_rest;
}

double SourceTerm::flat_wall_slope(double potential) const {
  if (linear_) return std::abs(potential);
  return part_.empty() ? 2 * std::sinh(std::abs(potential) / 2) : std::sqrt(2 * pressure(potential, 0));
}

double SourceTerm::layer_thickness(double potential) const {
  if (linear_ || potential == 0) return 1;
  if (part_.empty()) return 1 / std::cosh(potential / 2);
  return std::min(1.0, flat_wall_slope(potential) / std::abs(pressure_slope(potential, 0)));
}

double SourceTerm::potential_of_charge(double density) const {
  if (linear_) return density;
  if (part_.empty()) return 2 * std::asinh(density / 2);
  double below = 0, above = std::copysign(largest_, density);
  for (int i = 0; i < 200 && below != above; ++i) {
    const double middle = (below + above) / 2;
    (flat_wall_slope(middle) < std::abs(density) ? below : above) = middle;
  }
  return above;
}

}  // namespace pamr::poisson_boltzmann
