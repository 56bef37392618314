// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/goal_rest.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pamr/par/reproducible_sum.hpp"

namespace pamr::poisson_boltzmann {

double further_orders(double ratio) { return ratio < 0.5 ? ratio / (1 - ratio) : std::max(1.0, ratio); }

void GoalRest::add_square(std::size_t cell, double value, double decay) {
  const double rest = further_orders(decay * decay);
  add(cell, rest * value, 2 * std::sqrt(rest) * std::abs(value));
}

double GoalRest::bar(const par::Comm& comm) const {
  std::array<par::ExactSum, 3> sums;
  for (std::size_t c = 0; c < mean.size(); ++c) {
    sums[mean[c] > 0 ? 0 : 1].add(mean[c]);
    sums[2].add(spread[c] * spread[c]);
  }
  const auto totals = par::reproducible_sums(comm, sums);
  const double added = totals[0], taken = totals[1];
  return std::abs(added + taken) + 2 * std::sqrt(totals[2] + 0.25 * (added * added + taken * taken)) + unsolved;
}

}  // namespace pamr::poisson_boltzmann
