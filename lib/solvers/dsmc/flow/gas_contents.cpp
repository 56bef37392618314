// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/flow/gas_contents.hpp"

#include <array>
#include <cmath>

namespace pamr::dsmc {

using namespace geometry;

GasContents contents_of(const Flow& flow) {
  const auto& p = flow.particles;
  const auto& species = flow.setup().gas.species;
  const auto& units = flow.surface;
  std::array<WideSum, 7> wide;
  std::vector<std::int64_t> sums(2 * wide.size() + species.size(), 0);  // their words, and numbers of the species
  std::int64_t* const number = sums.data() + 2 * wide.size();
  const auto fixed = [](double value) { return std::llrint(value); };
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double w = species[p.species[i]].weight, m = w * species[p.species[i]].mass;
    const Vec3 v = p.velocity(i);
    wide[0].add(fixed(m * v.x / units.momentum_unit));
    wide[1].add(fixed(m * v.y / units.momentum_unit));
    wide[2].add(fixed(m * v.z / units.momentum_unit));
    wide[3].add(fixed(0.5 * m * squared_norm(v) / units.energy_unit));
    wide[4].add(fixed(w * p.rotation[i] / units.energy_unit));
    if (p.vibrate())
      wide[6].add(
          fixed(w * boltzmann * vibrational_energy(species[p.species[i]].vibration, p.levels[i]) / units.energy_unit));
    ++number[p.species[i]];
  }
  if (flow.setup().gas.is_weighted)
    for (const auto& cell : flow.collisions) wide[5].add(fixed(cell.energy_deficit / units.energy_unit));
  for (std::size_t k = 0; k < wide.size(); ++k) {
    sums[2 * k] = wide[k].low;
    sums[2 * k + 1] = wide[k].high;
  }
  flow.comm().sum_in_place(sums);
  const auto total = [&](std::size_t k) { return WideSum{sums[2 * k], sums[2 * k + 1]}.settled(); };
  GasContents contents{
      {number, number + species.size()}, {total(0), total(1), total(2)}, total(3), total(4), total(5), {}};
  if (p.vibrate()) contents.vibration = total(6);
  return contents;
}

std::vector<std::int64_t> total_fluxes(const par::Comm& comm, const FluxTally& flux) {
  auto words = flux.words();
  comm.sum_in_place(words);
  for (std::size_t row = 0; row < words.size(); row += FluxTally::words_of_row)
    for (std::size_t k = row + 1; k < row + FluxTally::words_of_row; k += 2) {
      const auto sum = WideSum{words[k], words[k + 1]}.settled();
      words[k] = sum.low;
      words[k + 1] = sum.high;
    }
  return words;
}

Temperatures temperatures_of(const GasContents& contents, const Flow& flow) {
  const auto& species = flow.setup().gas.species;
  const auto& units = flow.surface;
  double mass = 0, n = 0, weights = 0, degrees = 0;
  std::vector<double> counts;
  for (std::size_t s = 0; s < species.size(); ++s) {
    const auto n_here = static_cast<double>(contents.n[s]);
    n += n_here;
    const double count = species[s].weight * n_here;
    counts.push_back(count);
    mass += species[s].mass * count;
    weights += count;
    degrees += species[s].rotational_degrees * count;
  }
  if (n < 2) return {0, 0, contents.vibration ? std::optional(0.0) : std::nullopt};
  const auto& p = contents.momentum;
  const Vec3 momentum = units.momentum_unit * Vec3{p[0].value(), p[1].value(), p[2].value()};
  const double energy = units.energy_unit * contents.translation.value() - squared_norm(momentum) / (2 * mass);
  return {energy / (1.5 * boltzmann * (weights - weights / n)),
          degrees > 0 ? units.energy_unit * contents.rotation.value() / (0.5 * degrees * boltzmann) : 0,
          contents.vibration
              ? std::optional(temperature_of_vibration(flow.setup().gas.vibrations(), counts,
                                                       units.energy_unit * contents.vibration->value() / boltzmann))
              : std::nullopt};
}

}  // namespace pamr::dsmc
