// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace pamr::dsmc {

/// Mean of a series, and its change from end to end by the straight line through it, each with its standard error.
struct Line {
  double mean = 0, mean_error = 0;
  double change = 0, change_error = 0;
  std::size_t n = 0;  ///< values

  /// Half the width of the interval of 95 % of the change.
  double change_bound() const;
};
/// The line through equally spaced values, of which there are at least three. Local.
Line fit_line(std::span<const double> values);
/// Whether values that should only scatter change in one direction: by more than four standard errors (beyond which are
/// 0.4 % of ten values that scatter by chance, if neighbors do not depend on each other) and 0.5 % of their mean. Asked
/// of drag and heat after every group of averages, it is true by chance at some time in 2 % of runs of 20 groups and in 3 %
/// of 100; in 5 % and 8 % if neighbors depend on each other a little, as in tests/unit/dsmc/estimate_test.cpp. What begins
/// averages anew, the warning and the report all ask here.
bool drifts(const Line& line);

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
