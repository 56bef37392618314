// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/goal_rest.hpp"

#include <algorithm>
#include <cmath>

#include "pamr/base/index.hpp"
#include "pamr/par/reproducible_sum.hpp"

namespace pamr::poisson_boltzmann {

double further_orders(double ratio) { return ratio < 0.5 ? ratio / (1 - ratio) : std::max(1.0, ratio); }

void GoalRest::add_square(std::size_t cell, double value, double decay) {
  const double rest = further_orders(decay * decay);
  add(cell, rest * value, 2 * std::sqrt(rest) * std::abs(value));
}

CellsAtWalls find_cells_at_walls(const Problem& problem) {
  const auto& domain = problem.domain;
  const auto& patches = domain.mesh->info.patches;
  std::uint64_t all = 0;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const auto* b = problem.input.find_boundary(patches[p].name);
    if (b != nullptr && b->condition != Condition::symmetry) all |= std::uint64_t{1} << p;
  }
  CellsAtWalls result{{}, patches.size()};
  for (const auto& nodes : domain.mesh->cell_to_node) {
    std::uint64_t touched = 0;
    for (const auto node : nodes) touched |= domain.node_patches[pamr::at(node)];
    result.walls.push_back(touched & all);
  }
  return result;
}

double GoalRest::bar(const par::Comm& comm, const CellsAtWalls& at) const {
  enum { total, squares, added, taken, n_sums };
  std::vector<par::ExactSum> sums(n_sums + at.n_patches);  // then those of the walls
  for (std::size_t c = 0; c < mean.size(); ++c) {
    sums[total].add(mean[c]);
    sums[squares].add(spread[c] * spread[c]);
    if (at.walls[c] == 0) sums[mean[c] > 0 ? added : taken].add(mean[c]);
    for (std::size_t p = 0; p < at.n_patches; ++p)
      if ((at.walls[c] >> p & 1U) != 0) sums[n_sums + p].add(std::max(spread[c], std::abs(mean[c])));
  }
  const auto values = par::reproducible_sums(comm, sums);
  double alike = 0;
  for (std::size_t k = added; k < values.size(); ++k) alike += values[k] * values[k];
  return std::abs(values[total]) + 2 * std::sqrt(values[squares] + 0.25 * alike) + unsolved;
}

}  // namespace pamr::poisson_boltzmann
