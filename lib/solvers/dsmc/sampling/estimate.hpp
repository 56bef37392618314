// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace pamr::dsmc {

/// A mean with its standard error.
struct Estimate {
  double value = 0, error = 0;
};

/// Mean and standard error of independent values; the error is 0 for fewer than two. Local.
Estimate estimate(const std::vector<double>& values);

}  // namespace pamr::dsmc
