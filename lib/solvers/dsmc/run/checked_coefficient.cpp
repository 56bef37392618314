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
  return {fewer->value.value - all.value, std::hypot(all.error, fewer->value.error)};
}

double CheckedCoefficient::error() const {
  return fewer ? error_of_particles_per_difference(fewer->separation) * seen_or_hidden(difference()) : 0;
}

Estimate CheckedCoefficient::difference_of_cells() const {
  // Of the difference to a quarter of the particles: what partners at another distance change.
  const double apart = fewer->separation;
  const double part = error_of_particles_per_difference(apart) * (growth(apart, split->distance) - 1);
  return {split->value.value - all.value - part * difference().value,
          std::hypot(split->value.error, (1 - part) * all.error, part * fewer->value.error)};
}

double CheckedCoefficient::error_of_cells() const {
  return split ? error_of_cells_per_difference(split->size) * seen_or_hidden(difference_of_cells()) : 0;
}

nlohmann::json to_json(const CheckedCoefficient& one) {
  nlohmann::json shown{{"error", one.error()}, {"facets", one.facets}, {"bound", one.bound()}};
  if (one.fewer)
    shown.update({{"value", one.fewer->value.value},
                  {"ci95", one.fewer->student * one.fewer->value.error},
                  {"difference", one.difference().value},
                  {"difference_stderr", one.difference().error}});
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
  const double chance = one.student * one.all.error;
  const auto sum =
      fmt::format("and {:.4f} of flat facets make {:.4f} +- {:.4f}", one.facets, one.all.value, one.bound());
  if (!one.fewer) return fmt::format("{}, molecules without collisions: {:.4f} of chance {}", one.name, chance, sum);
  const auto& split = one.split;
  return fmt::format("{} {} with a quarter of the particles{}: {:.4f} of chance, {:.4f} of too few particles{} {}",
                     one.name, with_bounds(one.fewer->value, one.fewer->student),
                     split ? fmt::format(", {} with finer cells", with_bounds(split->value, split->student)) : "",
                     chance, one.error(), split ? fmt::format(", {:.4f} of coarse cells", one.error_of_cells()) : "",
                     sum);
}

}  // namespace pamr::dsmc
