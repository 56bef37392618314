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

/// Whether a flow is steady, and the reason in words.
struct Verdict {
  bool is_steady = false;
  std::string reason;
};

/// Compares the last two windows of `window` intervals of every series. A flow is steady when all series are. A series
/// is steady when
/// - in both windows the fitted straight line changes by at most max(3 standard errors, 0.5 % of the mean) and at most
///   5 % of the mean,
/// - and the means of the two windows differ by no more than that,
/// - or its mean is 0.
/// Local; the same on all ranks if the series are.
Verdict assess_steadiness(const std::vector<Series>& series, std::size_t window);

}  // namespace pamr::dsmc
