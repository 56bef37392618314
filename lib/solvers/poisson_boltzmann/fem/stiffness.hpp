// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "solvers/poisson_boltzmann/fem/petsc.hpp"
#include "solvers/poisson_boltzmann/fem/problem.hpp"

namespace pamr::poisson_boltzmann {

/// What the cells of this rank give to a symmetric matrix on its nodes: the diagonal and what lies left of it, by rows.
struct SymmetricRows {
  std::vector<std::size_t> offset{0};  ///< n_nodes + 1
  std::vector<LocalId> column;         ///< ascending in a row
  std::vector<double> value;
  std::vector<double> diagonal;  ///< n_nodes

  /// y = A x with the part of this rank; returns x . A x of it. `y` is overwritten. Local. A third faster than with
  /// all entries: half of the memory moves.
  double multiply(std::span<const double> x, std::span<double> y) const;
};

/// The matrix of -lap on all nodes, before any boundary condition: K_ij is the integral of grad phi_i . grad phi_j.
/// Entries that are zero but for rounding, as between corners at right angles in boxes, are
/// left out and added to the diagonal, so that the sums of rows stay; unless `keep_zeros`, for terms that are added to
/// the matrix later. Local. O(cells) time.
SymmetricRows stiffness_rows(const Domain& domain, bool keep_zeros = false);

/// Adds the integral of alpha v w over the far field, but of first order, where `Conditions::robin` has it lumped.
/// Local.
void add_far_field(const Problem& problem, SymmetricRows& rows);

/// The rows of all ranks for PETSc: rows of shared nodes are added up. Collective. Memory: the matrix twice while it is
/// made.
Matrix assemble_stiffness(const par::Comm& comm, const Domain& domain, const SymmetricRows& rows);

}  // namespace pamr::poisson_boltzmann
