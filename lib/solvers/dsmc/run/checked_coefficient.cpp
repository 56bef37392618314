// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/checked_coefficient.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

namespace pamr::dsmc {

namespace {

const double farther_with_fewer = std::cbrt(fewer_particles);  ///< distance of partners

/// sqrt(1 + (ratio x)^2) - 1 over sqrt(1 + x^2) - 1, without differences.
double growth(double x, double ratio) {
  const double further = ratio * x;
  return ratio * ratio * (std::sqrt(1 + x * x) + 1) / (std::sqrt(1 + further * further) + 1);
}

double seen_or_hidden(const Estimate& difference) {
  return std::max(std::fabs(difference.value), 2 * difference.error);
}

}  // namespace

double error_per_difference(double x, double ratio) {
  // (sqrt(1 + x^2) - 1) / |sqrt(1 + (ratio x)^2) - sqrt(1 + x^2)|, without differences.
  const double root = std::sqrt(1 + x * x), spread = ratio * ratio;
  return (std::sqrt(1 + spread * x * x) + root) / (std::fabs(spread - 1) * (root + 1));
}

double error_of_particles_per_difference(double separation) {
  return error_per_difference(separation, farther_with_fewer);
}

double error_of_cells_per_difference(double size) {
  return error_per_difference(std::sqrt(16 / (45 * std::numbers::pi)) * size, 0.5);
}

Estimate CheckedCoefficient::difference() const {
  return {fewer.value - all.value, std::hypot(all.error, fewer.error)};
}

double CheckedCoefficient::error() const {
  return error_of_particles_per_difference(separation) * seen_or_hidden(difference());
}

Estimate CheckedCoefficient::difference_of_cells() const {
  // Of the difference to a quarter of the particles: what partners at another distance change.
  const double part = error_of_particles_per_difference(separation) * (growth(separation, split->distance) - 1);
  return {split->value.value - all.value - part * (fewer.value - all.value),
          std::hypot(split->value.error, (1 - part) * all.error, part * fewer.error)};
}

double CheckedCoefficient::error_of_cells() const {
  return split ? error_of_cells_per_difference(split->size) * seen_or_hidden(difference_of_cells()) : 0;
}

nlohmann::json to_json(const CheckedCoefficient& one) {
  nlohmann::json shown{{"value", one.fewer.value},
                       {"ci95", one.student_fewer * one.fewer.error},
                       {"difference", one.difference().value},
                       {"difference_stderr", one.difference().error},
                       {"error", one.error()},
                       {"facets", one.facets},
                       {"bound", one.bound()}};
  if (one.split)
    shown["cells"] = {{"value", one.split->value.value},
                      {"ci95", one.split->student * one.split->value.error},
                      {"difference", one.difference_of_cells().value},
                      {"difference_stderr", one.difference_of_cells().error},
                      {"error", one.error_of_cells()}};
  return shown;
}

std::string describe(const CheckedCoefficient& one) {
  const auto with_bounds = [](const Estimate& e, double student) {
    return fmt::format("{:.4f} +- {:.4f}", e.value, student * e.error);
  };
  const auto& split = one.split;
  return fmt::format(
      "{} {} with a quarter of the particles{}: {:.4f} of chance, {:.4f} of too few particles{} and "
      "{:.4f} of flat facets make {:.4f} +- {:.4f}",
      one.name, with_bounds(one.fewer, one.student_fewer),
      split ? fmt::format(", {} with finer cells", with_bounds(split->value, split->student)) : "",
      one.student_all * one.all.error, one.error(),
      split ? fmt::format(", {:.4f} of coarse cells", one.error_of_cells()) : "", one.facets, one.all.value,
      one.bound());
}

}  // namespace pamr::dsmc
