// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pamr::dsmc {

/// Decides when cells should move to other ranks: when the processor time that was lost to imbalance since the last
/// move is as much as that move has cost, so that waiting never costs more than twice what the best moment would
/// (the rule for renting or buying: A. R. Karlin, M. S. Manasse, L. Rudolph, D. D. Sleator, "Competitive snoopy
/// caching", Algorithmica 3 (1988)). What moving cannot mend is not tried for ever: a move that leaves more than three
/// quarters of the imbalance doubles the loss that the next one waits for, up to 64 times.
class ShouldMove {
 public:
  /// Adds an interval of steps in which the slowest rank computed for `longest` seconds and the average one for `mean`.
  /// Returns true when it is time to move.
  bool add(double longest, double mean);
  /// Cells have moved, or would not have gained by it; the slowest rank computed so many seconds for that.
  void moved(double cost);

 private:
  double cost_ = 0, lost_ = 0;  ///< seconds, since the last move
  double patience_ = 1;         ///< how many times its cost the next one waits for
  double share_ = 0;            ///< of the mean that was lost in the last interval
  double before_ = -1;          ///< the same before the move, until an interval after it; else below 0
};

}  // namespace pamr::dsmc
