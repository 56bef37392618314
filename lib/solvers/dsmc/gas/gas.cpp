// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/gas/gas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "pamr/base/error.hpp"

namespace pamr::dsmc {

std::vector<const Vibration*> Gas::vibrations() const {
  std::vector<const Vibration*> all;
  for (const auto& s : species) all.push_back(&s.vibration);
  return all;
}

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

double Gas::heat_ratio(double t) const {
  double degrees = mean_degrees();
  if (is_vibrating)
    for (std::size_t i = 0; i < species.size(); ++i)
      degrees += 2 * fraction[i] * vibrational_heat(species[i].vibration, t);
  return (degrees + 2) / degrees;
}

bool is_hot(const Gas& gas, double temperature) {
  return temperature > 2500 &&
         std::any_of(gas.species.begin(), gas.species.end(), [](const Species& s) { return s.rotational_degrees > 0; });
}

const char* missing_when_hot(const Gas& gas) {
  if (gas.is_vibrating)
    return "above 2,500 K molecules react, which is not modeled: the real gas is cooler and has more atoms";
  return "above 2,500 K molecules vibrate and react; this run has no vibration ([gas] vibration = true), and reactions "
         "are not modeled: the real gas is cooler and has more atoms";
}

namespace {

void require_sound_vibration(const Species& s) {
  const auto& v = s.vibration;
  const bool sound = v.mode.size() <= max_modes && v.c1 > 0 && v.c2 >= 0 && v.cross_section >= 0 &&
                     s.rotational_degrees > 0 &&
                     std::all_of(v.mode.begin(), v.mode.end(), [](double theta) { return theta > 0; });
  if (!sound)
    throw Error(
        fmt::format("species {}: expected vibration of a molecule with rotational degrees, of at most {} modes, "
                    "temperatures and c1 above 0, c2 and cross_section 0 or above",
                    s.name, max_modes));
}

/// Those of pairs of one exponent are computed once.
std::vector<RelaxingShare> relaxing_shares(const std::vector<PairData>& pairs) {
  std::vector<RelaxingShare> shares;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto same =
        std::find_if(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(i),
                     [&](const auto& pair) { return pair.translational_exponent == pairs[i].translational_exponent; });
    const auto known = static_cast<std::size_t>(same - pairs.begin());
    if (known < i)
      shares.push_back(shares[known]);
    else
      shares.emplace_back(pairs[i].translational_exponent - 1);
  }
  return shares;
}

}  // namespace

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
  gas.is_weighted = gas.is_vibrating = false;
  for (const auto& s : gas.species) {
    if (!(s.weight > 0))
      throw Error(fmt::format("species {}: expected a weight above 0, found {:g}", s.name, s.weight));
    max_weight = std::max(max_weight, s.weight);
    gas.is_weighted = gas.is_weighted || s.weight != 1;
    if (s.vibration.mode.empty()) continue;
    require_sound_vibration(s);
    gas.is_vibrating = true;
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
  gas.relaxing_share.clear();
  if (gas.is_vibrating) gas.relaxing_share = relaxing_shares(gas.pairs);
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

double vibration_number(const Species& s, double t) {
  const auto& v = s.vibration;
  double number = v.c1 * std::pow(t, -s.omega) * std::exp(v.c2 / std::cbrt(t));
  if (v.cross_section > 0) {
    constexpr double reference = 50000;
    const double total = std::numbers::pi * s.diameter * s.diameter * std::pow(s.t_ref / t, s.omega - 0.5);
    const double part = t / reference;
    number += std::numbers::sqrt2 * total / v.cross_section * part * part;
  }
  return number;
}

double vibration_chance(const Gas& gas, std::size_t a, std::size_t b, std::size_t mode, double t) {
  constexpr double frozen = 40;  // e^-40 of the molecules are excited
  const auto& s = gas.species[a];
  const double theta = s.vibration.mode[mode];
  if (!(frozen * t > theta)) return 0;
  return 1 / (vibration_number(s, t) * gas.relaxing_share[a * gas.species.size() + b].at(theta / t));
}

}  // namespace pamr::dsmc
