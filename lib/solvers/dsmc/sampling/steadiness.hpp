// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace pamr::dsmc {

/// A quantity of the whole flow at equal intervals.
struct Series {
  std::string name;
  std::vector<double> value;
};

/// Whether a flow has come to rest, and why it is thought so.
struct Verdict {
  bool is_steady = false;
  std::string reason;
};

/// Looks at the last two windows of `window` intervals of every series. A series is steady when in each of the two the
/// straight line through its values changes by less than max(3 standard errors, 0.5 % of the mean), and at most by 5 %
/// of the mean, and the two means differ by no more than that either. A series whose mean is 0 counts as steady.
/// Local; the same on all ranks if the series are.
Verdict assess_steadiness(const std::vector<Series>& series, std::size_t window);

}  // namespace pamr::dsmc
