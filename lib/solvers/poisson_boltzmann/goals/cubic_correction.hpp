// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "solvers/poisson_boltzmann/fem/cubic_functions.hpp"
#include "solvers/poisson_boltzmann/goals/error_estimate.hpp"
#include "solvers/poisson_boltzmann/goals/goal_rest.hpp"

namespace pamr::poisson_boltzmann {

/// Error of a functional by functions of third order.
struct CubicGoalError : GoalError {
  GoalRest rest;              ///< what fourth and higher orders leave of it, and what the iterations did
  std::vector<double> dual;   ///< of all functions: the dual solution with its own error added
  std::vector<double> decay;  ///< n_cells: of the dual solution, as `CubicCorrection::decay`
};

/// Error e of a solution u of second order: what one Newton step on elements of third order would add, by a few
/// iterations of conjugate gradients. What is estimated from it is off by the product of two such errors only.
class CubicCorrection {
 public:
  /// Refers to `problem` for life. Collective: a few exchanges, and one for each iteration.
  CubicCorrection(const par::Comm& comm, const Problem& problem, std::span<const double> u);

  const CubicFunctions& functions() const { return functions_; }
  /// Coefficients of e.
  const std::vector<double>& error() const { return error_; }
  int iterations() const { return iterations_; }
  /// n_cells: how fast the orders of the solution fall off around a cell, the surplus of third order over that of
  /// second, in energy norms over all cells at its corners; that of order p is what the functions of p add to those
  /// below. Further orders are taken to fall off alike: for smooth functions on small cells they do so faster. Where a
  /// function is even about the cell, as between two walls of like potential, third order has next to nothing and
  /// fourth goes on from second: the ratio is then what the equation makes of second order in fourth, over third.
  const std::vector<double>& decay() const { return decay_; }

  /// e_K^2, the energy norm of e on each cell. `residual_squared` is 0: e has all of it. Collective: one reduction.
  Estimate estimate(const par::Comm& comm, std::span<const double> u) const;

  /// Error of a functional by its dual solution w of second order; `load` is its derivative by the coefficients of all
  /// functions (0 for those beyond its end). Shares are the products of the energy norms of e and of the same error of
  /// w. What the square of e adds by the slopes of the source term and of the charges of sites is in the correction as
  /// well. Collective.
  CubicGoalError goal_error(const par::Comm& comm, std::span<const double> w, std::span<const double> load) const;

  /// Adds what the energy of u is too large by, but for the part that its dual solution gives. Collective: one
  /// reduction.
  void add_energy_error(const par::Comm& comm, CubicGoalError& to) const;

 private:
  using Block = std::array<float, n_cubic*(n_cubic + 1) / 2>;
  struct FaceBlock {
    OfCubicFace<LocalId> function;
    std::array<double, 100> entry;
  };
  struct Solved {
    std::vector<double> value, residual;
    int iterations = 0;
    double rest = 0;  ///< squared energy norm of what is missing
  };

  void add_cell(const Problem& problem, std::size_t cell, std::span<const double> u);
  void add_face(const Problem& problem, std::size_t face, std::span<const double> u);
  std::vector<double> product(const par::Comm& comm, std::span<const double> x) const;
  std::vector<double> diagonal(const par::Comm& comm) const;
  Solved solve(const par::Comm& comm, std::vector<double> right, double to) const;
  double dot_owned(const par::Comm& comm, std::span<const double> a, std::span<const double> b) const;
  double product_of(std::size_t cell, const OfCubicCell<double>& a, const OfCubicCell<double>& b) const;
  OfCubicCell<double> of_cell(std::size_t cell, std::span<const double> x) const;
  std::vector<double> decay_of(const par::Comm& comm, std::span<const double> x) const;
  /// Fourth order over second on a cell by the equation, along the gradient of x; at most 1.
  double fourth_of(std::size_t cell, std::span<const double> x) const;
  void add_curvature(const par::Comm& comm, CubicGoalError& to) const;
  /// The part of a cell that comes from the curvature of the source term and of the charges of sites.
  std::vector<double> of_curvature(std::span<const double> dual) const;
  std::vector<double> cell_energy(std::span<const double> x) const;

  const Problem& problem_;
  CubicFunctions functions_;
  CubicConditions conditions_;
  std::vector<Block> block_;  ///< of the linearized equation, rows below and on the diagonal
  std::vector<FaceBlock> face_block_;
  std::vector<double> diagonal_;
  std::vector<double> right_;  ///< minus the residual of u
  std::vector<double> error_;
  std::vector<double> remaining_;  ///< residual of `error_`
  double rest_ = 0;                ///< squared energy norm of what `error_` misses
  std::vector<double> u_;
  std::vector<double> decay_;
  int iterations_ = 0;
};

}  // namespace pamr::poisson_boltzmann
