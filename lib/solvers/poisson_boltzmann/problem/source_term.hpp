// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solvers/poisson_boltzmann/problem/pb_case.hpp"

namespace pamr::poisson_boltzmann {

/// Potentials that a solution may pass through, kT/Ze: beyond it the squares of sinh overflow.
inline constexpr double largest_argument = 300;

/// What the equation has on its right-hand side, for the unknown u = psi - psi0 (psi0 = 0 where nothing is split off):
/// sinh(psi0 + u) - sinh(psi0) = 2 cosh(psi0 + u/2) sinh(u/2), or u where the equation is linear. Beyond
/// `largest_argument` sinh goes on as a straight line, so that a bad Newton step meets large numbers and no infinity.
class SourceTerm {
 public:
  explicit SourceTerm(bool linear) : linear_(linear) {}

  double value(double u, double psi0) const;
  /// d value / du.
  double slope(double u, double psi0) const;
  /// d slope / du: sinh(psi0 + u), or 0.
  double curvature(double u, double psi0) const;
  /// cosh(psi0 + u) - cosh(psi0), or ((psi0 + u)^2 - psi0^2) / 2: the osmotic pressure less that of psi0.
  double pressure(double u, double psi0) const;
  /// d pressure / du: sinh(psi0 + u), or psi0 + u.
  double pressure_slope(double u, double psi0) const;
  /// cosh(psi0 + u) - cosh(psi0) - u sinh(psi0) >= 0, or u^2/2: what the mid-plane form integrates. No cancellation.
  double convex_rest(double u, double psi0) const;

 private:
  bool linear_;
};

}  // namespace pamr::poisson_boltzmann
