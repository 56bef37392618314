// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <span>

#include "solvers/poisson_boltzmann/fem/conditions.hpp"
#include "solvers/poisson_boltzmann/problem/source_term.hpp"

namespace pamr::poisson_boltzmann {

/// What is solved: a case on a mesh. It refers to its three parts, which must outlive it and all that is made from it
/// (`System`, `State`); the terms of the equation are made once, here.
struct Problem {
  Problem(const Domain& on, const Case& stated, const Conditions& at_nodes)
      : domain(on), input(stated), conditions(at_nodes), term(stated.term()), profile(stated.profile()) {}

  const Domain& domain;
  const Case& input;
  const Conditions& conditions;
  SourceTerm term;
  PlateProfile profile;  ///< of the case's plate, whether it is split off or not; 0 without one

  /// The condition at a boundary face.
  const Boundary& boundary_of(const BoundaryFace& face) const {
    return *input.find_boundary(domain.mesh->info.patches[static_cast<std::size_t>(face.patch)].name);
  }
  /// psi0 at height z, and its derivative: the part of the potential that is split off; 0 where nothing is.
  double split_potential(double z) const { return input.split ? profile.potential(z) : 0; }
  double split_slope(double z) const { return input.split ? profile.slope(z) : 0; }
  /// Mean of that derivative over the heights of a face or a cell, by its nodes.
  double split_slope(std::span<const LocalId> nodes) const {
    if (!input.split) return 0;
    double low = domain.point[static_cast<std::size_t>(nodes[0])].z, high = low;
    for (const auto node : nodes) {
      low = std::min(low, domain.point[static_cast<std::size_t>(node)].z);
      high = std::max(high, domain.point[static_cast<std::size_t>(node)].z);
    }
    return profile.mean_slope(low, high);
  }
};

}  // namespace pamr::poisson_boltzmann
