// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "solvers/poisson_boltzmann/problem/units.hpp"

namespace pamr::poisson_boltzmann {

/// Potentials that a solution may pass through, kT/Ze: beyond it the squares of sinh overflow. That of `ions` is less by
/// their largest charge.
inline constexpr double largest_argument = 300;

/// What the equation has on its right-hand side, for the unknown u = psi - psi0 (psi0 = 0 where nothing is split off):
/// f(psi0 + u) - f(psi0), in one of three equations
/// - f = sinh(psi) of a Z:Z salt: the difference is 2 cosh(psi0 + u/2) sinh(u/2);
/// - f = psi, linear;
/// - f = - sum c_i z_i exp(-z_i psi) / sum c_i z_i^2 of ions with charges z_i, psi in kT/e.
/// Beyond `largest_argument` f goes on as a straight line, so that a bad Newton step meets large numbers and no
/// infinity.
class SourceTerm {
 public:
  /// `ions`: empty for a Z:Z salt; their charges add up to 0. No matter where the equation is linear.
  explicit SourceTerm(bool linear, const std::vector<Ion>& ions = {});

  double value(double u, double psi0) const;
  /// d value / du.
  double slope(double u, double psi0) const;
  /// d slope / du: sinh(psi0 + u) of a Z:Z salt, 0 if linear.
  double curvature(double u, double psi0) const;
  /// Integral of f from psi0 to psi0 + u: the osmotic pressure less that of psi0. cosh(psi0 + u) - cosh(psi0) of a Z:Z
  /// salt, ((psi0 + u)^2 - psi0^2) / 2 if linear, sum c_i (exp(-z_i (psi0 + u)) - exp(-z_i psi0)) / sum c_i z_i^2.
  double pressure(double u, double psi0) const;
  /// d pressure / du: f(psi0 + u).
  double pressure_slope(double u, double psi0) const;
  /// pressure - u f(psi0) >= 0, the integrand of the mid-plane form. No cancellation.
  double convex_rest(double u, double psi0) const;

  /// True for the equation with sinh.
  bool is_sinh() const { return !linear_ && part_.empty(); }
  /// -dpsi/dn in front of a flat wall of that potential, over the sign of psi: sqrt(2 pressure), 2 sinh(|psi|/2).
  double flat_wall_slope(double potential) const;
  /// Thickness of the layer of a wall of that potential, Debye lengths: psi'/psi'' in front of a flat wall, at most 1.
  /// 1/cosh(psi/2) of a Z:Z salt: the Gouy-Chapman length 2 exp(-psi/2) for large potentials and 1 for small ones.
  double layer_thickness(double potential) const;
  /// Potential of a flat wall with that charge density (Grahame): 2 asinh(sigma/2) of a Z:Z salt. Beyond
  /// `largest_argument` an end of that range.
  double potential_of_charge(double density) const;

 private:
  struct Part {
    double charge;  ///< z_i
    double weight;  ///< c_i / sum c z^2
  };
  template <class Term>
  double sum(const Term& term) const {
    double result = 0;
    for (const auto& part : part_) result += part.weight * term(part.charge);
    return result;
  }
  bool linear_;
  double largest_;  ///< argument
  std::vector<Part> part_;
};

}  // namespace pamr::poisson_boltzmann
