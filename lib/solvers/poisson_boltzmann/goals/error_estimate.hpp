// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "solvers/poisson_boltzmann/fem/problem.hpp"

namespace pamr::poisson_boltzmann {

/// Gradient of a P1 function on each cell. Local.
std::vector<geometry::Vec3> cell_gradients(const Domain& domain, std::span<const double> value);

/// Gradient at the nodes: the mean of the gradients of the cells around a node, weighted with their volumes or plain
/// (as the paper says it). On the boundary the mean is one-sided. After the nodes come the sides of sheets
/// (`Domain::sides`), with the mean over the cells of each side. `mark::nodal_means`. Collective: two exchanges, four
/// where there are sheets.
std::vector<geometry::Vec3> recover(const par::Comm& comm, const Domain& domain,
                                    std::span<const geometry::Vec3> cell_gradient, Recovery recovery);

/// The same of second order, whose gradient each cell has at its ten nodes. Collective: two exchanges.
std::vector<geometry::Vec3> recover(const par::Comm& comm, const Domain& domain, std::span<const double> u,
                                    Recovery recovery);

/// e_K^2: integral over each cell of |G* - grad u|^2, G* linear between its values at the nodes. Local.
std::vector<double> squared_errors(const Domain& domain, std::span<const geometry::Vec3> cell_gradient,
                                   std::span<const geometry::Vec3> recovered);

/// Error of the gradient of u, estimated by recovery (Zienkiewicz and Zhu 1987).
struct Estimate {
  std::vector<double> squared;           ///< e_K^2
  std::vector<double> residual_squared;  ///< (h_K/pi)^2 times the integral of the source term squared, h_K longest edge
  double total_squared = 0;
  double residual_total_squared = 0;
  double norm_squared = 0;  ///< integral of |grad u|^2
};

/// Collective: one reduction. The sums are exact and rounded once.
Estimate estimate_error(const par::Comm& comm, const Problem& problem, std::span<const double> u,
                        std::span<const geometry::Vec3> cell_gradient, std::span<const geometry::Vec3> recovered);

/// Error of a functional of the solution, by its dual solution w.
struct GoalError {
  /// Of each cell, not negative: the product of the recovered errors of u and w, and the error of nodal quadrature
  /// weighted with w. For marking; their sum is far above the error.
  std::vector<double> share;
  /// Estimate of J(u) - J(u_h) with its sign, to first order: the integral of (G* - grad u_h) . (W* - grad w_h) and
  /// what nodal quadrature adds, that of walls with sites included, on the meshed part. For a charge by nodal
  /// reactions, whose w is 1 on the patch and which is the residual with w, it is that with the other sign.
  double correction = 0;
  double recovered = 0;  ///< sum of the shares without what nodal quadrature has in them
  /// A bound for the error of nodal quadrature that remains after the correction: the further orders. The first order
  /// is computed from u_h and w, not estimated, so this is far smaller than its part of the shares.
  double lumped = 0;
};

/// Gradients of a dual solution (`dual_gradient.hpp`).
struct DualGradient {
  std::vector<geometry::Vec3> of_cells;   ///< n_cells
  std::vector<geometry::Vec3> recovered;  ///< in the order of `recover`, of the part that is smooth
  /// The rest is minus `along`, at the corners of cells, times the gradient of a cut-off function on them (n_cells;
  /// empty: there is none).
  std::vector<std::array<double, 4>> along;
  std::vector<geometry::Vec3> cut_off;

  /// At a corner of a cell, which has this number in the order of `recover`, as the cell sees it.
  geometry::Vec3 recovered_in(std::size_t cell, std::size_t corner, std::size_t number) const {
    return cut_off.empty() ? recovered[number] : recovered[number] - along[cell][corner] * cut_off[cell];
  }
};
struct GoalInput {
  std::span<const double> u, w;
  std::span<const geometry::Vec3> gradient_u, recovered_u;  ///< on cells, at nodes
  const DualGradient& dual;
  std::uint64_t counted = 0;  ///< patches of sites whose charge is the goal (bit p for patch p)
};
/// Collective: one reduction. Source: R. Becker, R. Rannacher, Acta Numerica 10 (2001), with recovered gradients.
GoalError goal_error(const par::Comm& comm, const Problem& problem, const GoalInput& input);

/// The same for the energy, the integral of |grad u|^2/2 + `term.pressure` with its nodal values: the energy of u_h is
/// above that of u by half of the squared error of the gradient, and nodal values of the convex pressure are too large.
/// `share` is not negative. Collective: one reduction.
GoalError energy_error(const par::Comm& comm, const Problem& problem, std::span<const double> u,
                       std::span<const double> squared_errors);

}  // namespace pamr::poisson_boltzmann
