// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/estimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pamr/base/contract.hpp"

namespace pamr::dsmc {

namespace {

constexpr std::size_t fewest_groups = 10;

/// Probability that a value of Student's distribution lies within -t and t, where t = sqrt(freedom) tan(angle): the
/// finite series of M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, 26.7.3 and 26.7.4.
double student_probability(double angle, std::size_t freedom) {
  const double sine = std::sin(angle), cosine = std::cos(angle);
  const bool is_odd = freedom % 2 == 1;
  double term = is_odd ? cosine : 1, sum = freedom > 1 ? term : 0;
  for (std::size_t k = is_odd ? 3 : 2; k < freedom; k += 2) {
    const auto x = static_cast<double>(k);
    term *= (x - 1) / x * cosine * cosine;
    sum += term;
  }
  return is_odd ? 2 / std::numbers::pi * (angle + sine * sum) : sine * sum;
}

}  // namespace

Estimate estimate(const std::vector<double>& values) { return estimate(values, values.size()); }

Estimate estimate(const std::vector<double>& values, std::size_t n_groups) {
  PAMR_EXPECTS(n_groups <= values.size());
  Estimate result;
  const double n = static_cast<double>(values.size());
  if (values.empty()) return result;
  for (const double v : values) result.value += v / n;
  if (n_groups < 2) return result;
  double squares = 0;
  for (std::size_t g = 0, begin = 0; g < n_groups; ++g) {
    const std::size_t end = (g + 1) * values.size() / n_groups;
    double deviation = 0;  // of the group's mean, times its part of all values
    for (; begin < end; ++begin) deviation += (values[begin] - result.value) / n;
    squares += deviation * deviation;
  }
  const auto m = static_cast<double>(n_groups);
  result.error = std::sqrt(squares * m / (m - 1));
  return result;
}

std::vector<double> group_means(const std::vector<double>& values, std::size_t n_groups) {
  PAMR_EXPECTS(n_groups > 0 && n_groups <= values.size());
  std::vector<double> means(n_groups);
  for (std::size_t g = 0, begin = 0; g < n_groups; ++g) {
    const std::size_t end = (g + 1) * values.size() / n_groups, n = end - begin;
    for (; begin < end; ++begin) means[g] += values[begin] / static_cast<double>(n);
  }
  return means;
}

Grouping group_blocks(std::size_t n_blocks, std::int64_t steps_per_block, std::int64_t passage) {
  PAMR_EXPECTS(steps_per_block > 0 && passage > 0);
  Grouping result;
  if (n_blocks == 0) return result;
  const auto blocks_per_passage = static_cast<std::size_t>((passage + steps_per_block - 1) / steps_per_block);
  result.n_groups = std::max(n_blocks / blocks_per_passage, std::min(n_blocks, fewest_groups));
  result.steps = static_cast<std::int64_t>(n_blocks / result.n_groups) * steps_per_block;
  result.are_independent = result.n_groups >= fewest_groups && result.steps >= passage;
  return result;
}

double student_95(std::size_t n) {
  if (n < 2) return std::numeric_limits<double>::infinity();
  const std::size_t freedom = std::min<std::size_t>(n - 1, 1000);
  double low = 0, high = std::numbers::pi / 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (student_probability(middle, freedom) < 0.95 ? low : high) = middle;
  }
  return std::sqrt(static_cast<double>(freedom)) * std::tan(low);
}

}  // namespace pamr::dsmc
