// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pamr::dsmc {

/// Decides when cells should move to other ranks: when the mean cost of a step since the last move,
/// (processor time lost to imbalance + cost of the last move) / steps, rises for the first time.
/// Source: D. M. Nicol, J. H. Saltz, "Dynamic remapping of parallel computations with varying resource demands", IEEE
/// Trans. Comput. 37 (1988): the stop-at-rise rule.
class StopAtRise {
 public:
  /// Adds `n_steps` steps in which the slowest rank computed for `longest` seconds and the average one for `mean`.
  /// Returns true when it is time to move.
  bool add(double n_steps, double longest, double mean);
  /// Cells have moved; it took so many seconds.
  void moved(double cost);

 private:
  double lost_ = 0, cost_ = 0, steps_ = 0, last_ = -1;
};

}  // namespace pamr::dsmc
