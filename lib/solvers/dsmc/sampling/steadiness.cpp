// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/steadiness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace pamr::dsmc {

namespace {

/// A straight line through equally spaced values.
struct Line {
  double mean = 0;
  double mean_error = 0;
  double change = 0;  ///< over the window
  double change_error = 0;
};

Line fit(std::span<const double> y) {
  Line line;
  const double n = static_cast<double>(y.size());
  for (const double v : y) line.mean += v / n;
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double x = static_cast<double>(i) - 0.5 * (n - 1);
    xx += x * x;
    xy += x * (y[i] - line.mean);
  }
  const double slope = xy / xx;
  double rest = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double d = y[i] - line.mean - slope * (static_cast<double>(i) - 0.5 * (n - 1));
    rest += d * d;
  }
  const double variance = rest / (n - 2);
  line.mean_error = std::sqrt(variance / n);
  line.change = slope * n;
  line.change_error = std::sqrt(variance / xx) * n;
  return line;
}

}  // namespace

Verdict assess_steadiness(const std::vector<Series>& series, std::size_t window) {
  Verdict verdict{true, {}};
  const auto windows = fmt::format("the last two windows of {} intervals", window);
  for (const auto& s : series) {
    if (s.value.size() < 2 * window) return {false, fmt::format("fewer than two windows of {} intervals yet", window)};
    const std::span<const double> all(s.value);
    const auto first = fit(all.subspan(all.size() - 2 * window, window)), last = fit(all.last(window));
    const double size = std::fabs(last.mean);
    if (size == 0) continue;
    const auto small = [&](double change, double error) {
      return std::fabs(change) <= std::max(3 * error, 0.005 * size) && std::fabs(change) <= 0.05 * size;
    };
    const double step = last.mean - first.mean, step_error = std::hypot(first.mean_error, last.mean_error);
    const bool ok =
        small(first.change, first.change_error) && small(last.change, last.change_error) && small(step, step_error);
    verdict.is_steady = verdict.is_steady && ok;
    verdict.reason += fmt::format("{}{} {} by {:+.2f} % and {:+.2f} % in {}, their means by {:+.2f} %",
                                  verdict.reason.empty() ? "" : "; ", s.name, ok ? "changed only" : "still changes",
                                  100 * first.change / size, 100 * last.change / size, windows, 100 * step / size);
  }
  return verdict;
}

}  // namespace pamr::dsmc
