// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>

#include "solvers/poisson_boltzmann/fem/problem.hpp"

namespace pamr::poisson_boltzmann {

/// Stress of the liquid on a plane of normal n: g (g.n) - (|g|^2/2 + pressure) n, with g = grad psi or -grad psi and
/// the osmotic pressure cosh psi - 1. Local.
inline geometry::Vec3 stress(geometry::Vec3 g, geometry::Vec3 n, double pressure = 0) {
  return dot(g, n) * g - (0.5 * squared_norm(g) + pressure) * n;
}

/// `stress(base + g, n)` less `stress(base, n)` without cancellation, however large `base` is. Local.
inline geometry::Vec3 added_stress(geometry::Vec3 g, geometry::Vec3 base, geometry::Vec3 n) {
  return dot(g + base, n) * g + dot(g, n) * base - (0.5 * squared_norm(g) + dot(g, base)) * n;
}

/// Charge density -dpsi/dn of a wall at one of its nodes by the nodal reaction, the charge that holds the given
/// potential there, with that of the split-off profile; nothing where no potential is given. `normal` points out of the
/// liquid. Local.
inline std::optional<double> reaction_charge(const Problem& problem, std::span<const double> reaction,
                                             geometry::Vec3 normal, std::size_t node) {
  const auto& conditions = problem.conditions;
  if (conditions.fixed[node] == 0 || !(conditions.fixed_area[node] > 0)) return std::nullopt;
  return reaction[node] / conditions.fixed_area[node] + normal.z * problem.split_slope(problem.domain.point[node].z);
}

}  // namespace pamr::poisson_boltzmann
