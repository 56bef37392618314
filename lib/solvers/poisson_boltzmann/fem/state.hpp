// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pamr/par/reproducible_sum.hpp"
#include "solvers/poisson_boltzmann/fem/mirrors.hpp"
#include "solvers/poisson_boltzmann/fem/problem.hpp"

namespace pamr::poisson_boltzmann {

class CubicCorrection;

/// A solution and its gradients, for what is computed from them. Refers to everything; nothing is copied.
struct State {
  const Problem& problem;
  std::span<const double> u;                      ///< n_nodes
  std::span<const double> reaction;               ///< n_nodes
  std::span<const geometry::Vec3> cell_gradient;  ///< n_cells: of u
  std::span<const geometry::Vec3> recovered;      ///< gradient of u, in the order of `recover`
  std::span<const Mirrors> mirrors;               ///< n_patches
  const CubicCorrection* cubic = nullptr;         ///< of second order: its error
};

/// Adds up vectors exactly: the same bits on any number of ranks.
struct VectorSum {
  std::array<par::ExactSum, 3> sum;

  void add(geometry::Vec3 v) {
    for (std::size_t axis = 0; axis < 3; ++axis) sum[axis].add(v[axis]);
  }
  /// Collective: one reduction.
  geometry::Vec3 total(const par::Comm& comm) {
    const auto values = par::reproducible_sums(comm, sum);
    return {values[0], values[1], values[2]};
  }
};

}  // namespace pamr::poisson_boltzmann
