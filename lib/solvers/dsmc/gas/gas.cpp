// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/gas/gas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "pamr/base/error.hpp"

namespace pamr::dsmc {

double Gas::mean_mass() const {
  double sum = 0;
  for (std::size_t i = 0; i < species.size(); ++i) sum += fraction[i] * species[i].mass;
  return sum;
}

double Gas::mean_degrees() const {
  double sum = 3;
  for (std::size_t i = 0; i < species.size(); ++i) sum += fraction[i] * species[i].rotational_degrees;
  return sum;
}

double Gas::heat_ratio() const { return (mean_degrees() + 2) / mean_degrees(); }

bool lacks_vibration(const Gas& gas, double temperature) {
  return temperature > 2500 &&
         std::any_of(gas.species.begin(), gas.species.end(), [](const Species& s) { return s.rotational_degrees > 0; });
}

void prepare(Gas& gas) {
  if (gas.species.empty() || gas.species.size() != gas.fraction.size())
    throw Error("expected a gas of at least one species with a fraction for each");
  for (const auto& s : gas.species) {
    const bool sound = s.mass > 0 && s.mass < 1e-20 && s.diameter > 0 && s.diameter < 1e-6 && s.omega >= 0.5 &&
                       s.omega <= 1 && s.t_ref > 0 && s.alpha >= 1 && s.alpha <= 2 && s.rotational_degrees >= 0 &&
                       s.rotational_degrees <= 3;
    if (!sound)
      throw Error(fmt::format(
          "species {}: expected mass and diameter in kg and m, 0.5 <= omega <= 1, t_ref > 0, 1 <= alpha <= 2 and 0, 2 "
          "or 3 rotational degrees, found mass {} diameter {} omega {} t_ref {} alpha {} rotational degrees {}",
          s.name, s.mass, s.diameter, s.omega, s.t_ref, s.alpha, s.rotational_degrees));
  }
  double max_weight = 0;
  gas.is_weighted = false;
  for (const auto& s : gas.species) {
    if (!(s.weight > 0))
      throw Error(fmt::format("species {}: expected a weight above 0, found {:g}", s.name, s.weight));
    max_weight = std::max(max_weight, s.weight);
    gas.is_weighted = gas.is_weighted || s.weight != 1;
  }
  if (max_weight != 1)
    throw Error(fmt::format("expected species' weights of which the greatest is 1, found {:g}", max_weight));
  gas.pairs.clear();
  for (const auto& a : gas.species)
    for (const auto& b : gas.species) {
      PairData pair;
      const double omega = 0.5 * (a.omega + b.omega), diameter = 0.5 * (a.diameter + b.diameter);
      const double t_ref = 0.5 * (a.t_ref + b.t_ref);
      pair.reduced_mass = a.mass * b.mass / (a.mass + b.mass);
      pair.exponent = 1 - omega;
      pair.coefficient = std::numbers::pi * diameter * diameter *
                         std::pow(2 * boltzmann * t_ref / pair.reduced_mass, omega - 0.5) / std::tgamma(2.5 - omega);
      pair.mass_part_a = a.mass / (a.mass + b.mass);
      pair.mass_part_b = b.mass / (a.mass + b.mass);
      pair.inverse_alpha = 2 / (a.alpha + b.alpha);
      pair.translational_exponent = 2.5 - omega;
      pair.weight = std::max(a.weight, b.weight);
      gas.pairs.push_back(pair);
    }
}

double particles_per_molecule(const Gas& gas, const std::vector<double>& fraction) {
  double sum = 0;
  for (std::size_t i = 0; i < fraction.size(); ++i) sum += fraction[i] / gas.species[i].weight;
  return sum;
}

double relaxation_probability(const Rotation& rotation, int rotational_degrees, double omega, double t) {
  if (rotational_degrees == 0) return 0;
  if (rotation.model == Rotation::Model::probability) return rotation.value;
  double z = rotation.value;
  if (rotation.model == Rotation::Model::variable) {
    constexpr double pi = std::numbers::pi;
    const double ratio = rotation.t_star / t;
    z = rotation.z_infinity / (1 + 0.5 * std::pow(pi, 1.5) * std::sqrt(ratio) + (pi + 0.25 * pi * pi) * ratio);
  }
  const double translational = 5 - 2 * omega;
  return (rotational_degrees + translational) / (z * translational);
}

}  // namespace pamr::dsmc
