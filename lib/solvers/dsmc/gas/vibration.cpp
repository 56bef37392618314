// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/gas/vibration.hpp"

#include <algorithm>
#include <array>

namespace pamr::dsmc {

namespace {

/// Heat capacity of an oscillator over Boltzmann's constant; `x`: characteristic temperature over temperature.
double heat_of_mode(double x) {
  const double half = 0.5 * x, sinh = std::sinh(half);
  return std::isfinite(sinh) ? half * half / (sinh * sinh) : 0;
}

double energy_of_mode(double theta, double t) { return t > 0 ? theta / std::expm1(theta / t) : 0; }

// Ratios of the table: equal distances of their logarithms.
constexpr double first_ratio = 0.1, last_ratio = 16;
constexpr std::size_t n_ratios = 65;
const double log_step = std::log(last_ratio / first_ratio) / (n_ratios - 1);

/// Gauss-Legendre points and weights on (0, 1).
constexpr std::array<double, 8> gauss_point{0.019855071751231884, 0.10166676129318664, 0.2372337950418355,
                                            0.4082826787521751,   0.5917173212478249,  0.7627662049581645,
                                            0.8983332387068134,   0.9801449282487681};
constexpr std::array<double, 8> gauss_weight{0.05061426814518813, 0.11119051722668724, 0.15685332293894363,
                                             0.1813418916891810,  0.1813418916891810,  0.15685332293894363,
                                             0.11119051722668724, 0.05061426814518813};

/// Numbers of states of a pair whose energy is `energy` (units of k theta): sum of (energy - v)^exponent over the
/// levels, and the same times the level v, squared, over the former; times the weight of the energy in integrals.
struct Node {
  double energy = 0, square = 0;
};

std::vector<Node> nodes(double exponent) {
  const auto n_levels = static_cast<std::size_t>(42 / first_ratio);
  std::vector<Node> all;
  std::array<double, 8> states{}, levels{};
  for (std::size_t v = 0; v < n_levels; ++v)
    for (std::size_t k = 0; k < gauss_point.size(); ++k) {
      const double rest = gauss_point[k] * gauss_point[k];  // squared, for the root at each new level
      levels[k] += states[k];
      states[k] += std::pow(static_cast<double>(v) + rest, exponent);
      all.push_back(
          {static_cast<double>(v) + rest, levels[k] * levels[k] / states[k] * 2 * gauss_point[k] * gauss_weight[k]});
    }
  return all;
}

}  // namespace

double mean_vibrational_energy(const Vibration& vibration, double t) {
  double sum = 0;
  for (const double theta : vibration.mode) sum += energy_of_mode(theta, t);
  return sum;
}

double vibrational_heat(const Vibration& vibration, double t) {
  double sum = 0;
  for (const double theta : vibration.mode) sum += t > 0 ? heat_of_mode(theta / t) : 0;
  return sum;
}

double temperature_of_vibration(const std::vector<const Vibration*>& kinds, const std::vector<double>& n,
                                double energy) {
  double modes = 0, warmest = 0, coolest = 1e300;
  for (std::size_t s = 0; s < kinds.size(); ++s)
    for (const double theta : kinds[s]->mode) {
      if (!(n[s] > 0)) continue;
      modes += n[s];
      warmest = std::max(warmest, theta);
      coolest = std::min(coolest, theta);
    }
  if (!(modes > 0 && energy > 0)) return 0;
  if (warmest == coolest) return warmest / std::log1p(warmest * modes / energy);
  // A mode has more than k (T - theta / 2).
  double low = 0, high = energy / modes + 0.5 * warmest;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    double found = 0;
    for (std::size_t s = 0; s < kinds.size(); ++s) found += n[s] * mean_vibrational_energy(*kinds[s], middle);
    (found < energy ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

RelaxingShare::RelaxingShare(double exponent) : exponent_(exponent) {
  const auto all = nodes(exponent);
  for (std::size_t i = 0; i < n_ratios; ++i) {
    const double x = first_ratio * std::exp(static_cast<double>(i) * log_step);
    double sum = 0;
    for (const auto& node : all) sum += node.square * std::exp(-x * node.energy);
    const double q = std::exp(-x), mean = q / (1 - q), variance = mean / (1 - q);
    const double pairs = std::tgamma(exponent + 1) / std::pow(x, exponent + 1) / (1 - q);
    table_.push_back(1 - (sum / pairs - mean * mean) / variance);
  }
}

double RelaxingShare::at(double ratio) const {
  if (ratio <= first_ratio) return (exponent_ + 1) / (exponent_ + 1 + heat_of_mode(ratio));
  const double place = std::log(std::min(ratio, last_ratio) / first_ratio) / log_step;
  const auto i = std::min(static_cast<std::size_t>(place), n_ratios - 2);
  const double part = place - static_cast<double>(i);
  return (1 - part) * table_[i] + part * table_[i + 1];
}

}  // namespace pamr::dsmc
