// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/should_move.hpp"

#include <algorithm>

namespace pamr::dsmc {

bool ShouldMove::add(double longest, double mean) {
  constexpr double max_patience = 64;
  lost_ += longest - mean;
  share_ = mean > 0 ? longest / mean - 1 : 0;
  if (before_ >= 0) patience_ = share_ > 0.75 * before_ && before_ > 0 ? std::min(2 * patience_, max_patience) : 1;
  before_ = -1;
  return lost_ > patience_ * cost_;
}

void ShouldMove::moved(double cost) {
  cost_ = cost;
  lost_ = 0;
  before_ = share_;
}

}  // namespace pamr::dsmc
