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
  std::array<par::ExactSum, 2> sums;
  for (std::size_t c = 0; c < mean.size(); ++c) {
    sums[0].add(mean[c]);
    sums[1].add(spread[c] * spread[c]);
  }
  const auto totals = par::reproducible_sums(comm, sums);
  return std::abs(totals[0]) + 2 * std::sqrt(totals[1]) + unsolved;
}

}  // namespace pamr::poisson_boltzmann
