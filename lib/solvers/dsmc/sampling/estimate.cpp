// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/estimate.hpp"

#include <cmath>

namespace pamr::dsmc {

Estimate estimate(const std::vector<double>& values) {
  Estimate result;
  const double n = static_cast<double>(values.size());
  if (values.empty()) return result;
  for (const double v : values) result.value += v / n;
  if (values.size() < 2) return result;
  double squares = 0;
  for (const double v : values) squares += (v - result.value) * (v - result.value);
  result.error = std::sqrt(squares / (n - 1) / n);
  return result;
}

}  // namespace pamr::dsmc
