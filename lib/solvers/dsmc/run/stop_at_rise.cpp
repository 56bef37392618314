// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/stop_at_rise.hpp"

namespace pamr::dsmc {

bool StopAtRise::add(double n_steps, double longest, double mean) {
  lost_ += longest - mean;
  steps_ += n_steps;
  const double now = (lost_ + cost_) / steps_;
  const bool rises = last_ >= 0 && now > last_;
  last_ = now;
  return rises;
}

void StopAtRise::moved(double cost) {
  *this = {};
  cost_ = cost;
}

}  // namespace pamr::dsmc
