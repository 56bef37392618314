// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pamr/par/comm.hpp"
#include "solvers/poisson_boltzmann/fem/problem.hpp"

namespace pamr::poisson_boltzmann {

/// What all further orders add up to, over the last one, if each is `ratio` times the one before: ratio + ratio^2 + ...
/// At most 1, as large as the last one, or `ratio` itself where that is larger: what only one further order has.
double further_orders(double ratio);

/// The walls that cells touch: patches with a condition other than that of a mirror.
struct CellsAtWalls {
  std::vector<std::uint64_t> walls;  ///< n_cells: bit p for patch p
  std::size_t n_patches = 0;
};
/// Local.
CellsAtWalls find_cells_at_walls(const Problem& problem);

/// What is left of a goal's error after the correction by functions of third order.
///
/// The corrected value is that of third order, J(u3), whose error is a(u - u3, w - w3), cell by cell. Both factors are
/// taken to go on as the orders before: u - u3 is `decay` of u times e3, what third order adds to second, w - w3
/// likewise. That gives the size of what a cell adds, the product of the energy norms, not its sign. Each cell is taken
/// to add a random number: its mean is what the product a(e3, w3) on the cell gives with its sign, which counts where
/// all cells err alike, its standard deviation is the product of the norms, the largest value that it can have.
///
/// The means have an error that does not average out, as the orders of cells in like places go on after third in like
/// ways. Cells at a wall are alike: how e4 lies to w4 there may differ from how e3 lies to w3, and does so in all of
/// them. So what the cells at wall p add is at most the sum S_p of their largest values, the larger of |mean| and
/// spread, which is two standard deviations. Of the other cells an extrapolated sum is taken to lie between 0 and twice
/// itself, those that add (P) and those that take away (N) apart. So the bar is
///
///     |sum mean_K| + 2 sqrt(sum spread_K^2 + (sum of S_p^2 + P^2 + N^2)/4) + unsolved
///
/// with two standard deviations as everywhere, none of it fitted to known errors.
struct GoalRest {
  std::vector<double> mean, spread;  ///< n_cells
  double unsolved = 0;               ///< what iterations left; a bound if they go on as they did

  explicit GoalRest(std::size_t n_cells = 0) : mean(n_cells, 0), spread(n_cells, 0) {}
  void add(std::size_t cell, double of_mean, double of_spread) {
    mean[cell] += of_mean;
    spread[cell] += of_spread;
  }
  /// What remains of a quantity of e squared whose value with e3 on this cell is known: the square of the further
  /// orders, and twice their product with e3.
  void add_square(std::size_t cell, double value, double decay);
  /// Collective: four exact sums, and one for each patch.
  double bar(const par::Comm& comm, const CellsAtWalls& at) const;
};

}  // namespace pamr::poisson_boltzmann
