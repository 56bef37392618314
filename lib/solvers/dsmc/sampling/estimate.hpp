// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pamr::dsmc {

/// A mean with its standard error.
struct Estimate {
  double value = 0, error = 0;
};

/// Mean and standard error of independent values; the error is 0 for fewer than two. Local.
Estimate estimate(const std::vector<double>& values);
/// Mean of all values, with the standard error from the means of `n_groups` runs of neighboring values, of equal length
/// or one longer: for values that depend on their neighbors. `n_groups` is at most the number of values. Local.
Estimate estimate(const std::vector<double>& values, std::size_t n_groups);

/// Means of `n_groups` runs of neighboring values, of equal length or one longer. `n_groups` is at least 1 and at most
/// the number of values. Local.
std::vector<double> group_means(const std::vector<double>& values, std::size_t n_groups);

/// Runs of neighboring blocks of steps for the error of their mean.
struct Grouping {
  std::size_t n_groups = 0;
  std::int64_t steps = 0;        ///< of the shortest group
  bool are_independent = false;  ///< every group is at least as long as a passage, and there are ten or more
};
/// As many groups as are at least `passage` steps long, the time after which the flow has forgotten itself; or, if
/// these are fewer than ten, ten shorter ones (or every block by itself), because an error from fewer means little.
/// Local.
Grouping group_blocks(std::size_t n_blocks, std::int64_t steps_per_block, std::int64_t passage);

/// The multiple of its standard error within which a mean of `n` independent normal values lies of the true one with a
/// probability of 95 %: Student's factor for n - 1 degrees of freedom, taken as 1000 where they are more; infinite for
/// n < 2. Local.
double student_95(std::size_t n);

}  // namespace pamr::dsmc
