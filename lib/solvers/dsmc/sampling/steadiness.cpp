// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/steadiness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pamr/base/contract.hpp"
#include "solvers/dsmc/sampling/estimate.hpp"

namespace pamr::dsmc {

namespace {

constexpr double unimportant = 0.005;  ///< change of a quantity, over its mean

}  // namespace

Line fit_line(std::span<const double> values) {
  PAMR_EXPECTS(values.size() > 2);
  Line line;
  line.n = values.size();
  const double n = static_cast<double>(values.size());
  for (const double v : values) line.mean += v / n;
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = static_cast<double>(i) - 0.5 * (n - 1);
    xx += x * x;
    xy += x * (values[i] - line.mean);
  }
  const double slope = xy / xx;
  double rest = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double d = values[i] - line.mean - slope * (static_cast<double>(i) - 0.5 * (n - 1));
    rest += d * d;
  }
  const double variance = rest / (n - 2);
  line.mean_error = std::sqrt(variance / n);
  line.change = slope * n;
  line.change_error = std::sqrt(variance / xx) * n;
  return line;
}

double Line::change_bound() const { return student_95(n - 1) * change_error; }  // n - 2 degrees of freedom

bool drifts(const Line& line) {
  return std::fabs(line.change) > std::max(4 * line.change_error, unimportant * std::fabs(line.mean));
}

Verdict assess_steadiness(const std::vector<Series>& series, std::size_t window) {
  Verdict verdict{true, {}};
  const auto windows = fmt::format("the last two windows of {} intervals", window);
  for (const auto& s : series) {
    if (s.value.size() < 2 * window) return {false, fmt::format("fewer than two windows of {} intervals yet", window)};
    const std::span<const double> all(s.value);
    const auto first = fit_line(all.subspan(all.size() - 2 * window, window)), last = fit_line(all.last(window));
    const double size = std::fabs(last.mean);
    if (size == 0) continue;
    const auto small = [&](double change, double error) {
      return std::fabs(change) <= std::max(3 * error, unimportant * size) && std::fabs(change) <= 0.05 * size;
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
