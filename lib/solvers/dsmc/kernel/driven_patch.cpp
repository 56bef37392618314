// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/driven_patch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"
#include "solvers/dsmc/kernel/vibrate.hpp"

namespace pamr::dsmc {

using namespace geometry;
using Way = FluxTally::Way;

namespace {

/// Out of the gas an outlet may be passed this much faster than sound: hardly anything enters any more.
constexpr double max_mach_out = 10;

/// Net flux over what enters of a Maxwellian with speed ratio s: rises from 0 towards 1.
double net_share(double s) { return 2 * std::sqrt(std::numbers::pi) * s / flux_factor(s); }

/// The speed ratio at which it is `share`; at most `high`. By bisection: the same on every rank.
double ratio_of_share(double share, double high) {
  if (!(share < net_share(high))) return high;
  double low = 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (net_share(middle) < share ? low : high) = middle;
  }
  return low;
}

}  // namespace

DrivenPatch::DrivenPatch(const par::Comm& comm, const GasDomain& domain, const Gas& gas, const Kind& kind,
                         const Scale& scale)
    : gas_(&gas), patch_(kind.patch), condition_(kind.condition), scale_(scale), before_(2 * gas.species.size()) {
  const auto& stream = kind.stream;
  const bool is_outlet = condition_.kind == BoundaryCondition::Kind::outlet;
  par::ExactSum area;
  for (const auto& face : domain.boundary) {
    if (face.patch != patch_) continue;
    area.add(face.area);
    const auto cell = at(face.cell);
    if (is_outlet && (cell_.empty() || cell_.back().cell != cell)) cell_.push_back({cell, face.normal});
  }
  area_ = par::reproducible_sums(comm, {&area, 1}).front();
  if (!(area_ > 0)) area_ = 1;  // no faces: nothing enters
  entering_.gas = stream;
  entering_.gas.velocity = {};
  const auto n = gas.species.size();
  entering_.species.resize(n);
  mean_.assign(is_outlet ? momentum() + (gas.is_vibrating ? 6 : 5) : 2 * n, 0.0);
  for (std::size_t s = 0; s < n && is_outlet; ++s) {  // one particle
    const double weight = gas.species[s].weight;
    mean_[count(s)] = stream.fraction[s] / weight;
    mean_[momentum() + 3] += stream.fraction[s] * boltzmann * stream.temperature / scale.energy_unit;
    mean_[momentum() + 4] += stream.fraction[s] * 0.5 * gas.species[s].rotational_degrees * boltzmann *
                             stream.rotational_temperature / scale.energy_unit;
    if (gas.is_vibrating)
      mean_[momentum() + 5] += stream.fraction[s] * boltzmann *
                               mean_vibrational_energy(gas.species[s].vibration, stream.vibrational_temperature) /
                               scale.energy_unit;
  }
  if (condition_.mass_flow > 0) {
    const double mass = mass_of(stream.fraction);
    const double speed = std::min(sound(), condition_.mass_flow / (stream.density * mass * area_));
    for (std::size_t s = 0; s < n; ++s)
      mean_[out(s)] =
          molecular_flux(stream.density * stream.fraction[s], stream.temperature, gas.species[s].mass, -speed) * area_ /
          (scale.fnum_per_time * gas.species[s].weight);
  }
  update();
}

void DrivenPatch::begin_step(const FluxTally& flux) {
  for (std::size_t s = 0; s < gas_->species.size(); ++s) {
    before_[out(s)] = flux.count(at(patch_), Way::out, s);
    before_[in(s)] = flux.count(at(patch_), Way::in, s);
  }
}

void DrivenPatch::append_words(const FluxTally& flux, const Particles& particles,
                               std::vector<std::int64_t>& words) const {
  const auto first = words.size();
  words.resize(first + n_words(), 0);
  const auto here = std::span(words).subspan(first);
  for (std::size_t s = 0; s < gas_->species.size(); ++s) {
    here[out(s)] = flux.count(at(patch_), Way::out, s) - before_[out(s)];
    here[in(s)] = flux.count(at(patch_), Way::in, s) - before_[in(s)];
  }
  const auto begin = particles.begin();
  for (const auto& [cell, normal] : cell_)
    for (auto i = begin[cell]; i < begin[cell + 1]; ++i) {
      const auto& species = gas_->species[particles.species[i]];
      const double mass = species.weight * species.mass;
      const Vec3 v = particles.velocity(i), aside = v - dot(v, normal) * normal;
      ++here[count(particles.species[i])];
      for (std::size_t k = 0; k < 3; ++k)
        here[momentum() + k] += SurfaceTally::fixed(mass * aside[k] / scale_.momentum_unit);
      here[momentum() + 3] += SurfaceTally::fixed(0.5 * mass * squared_norm(aside) / scale_.energy_unit);
      here[momentum() + 4] += SurfaceTally::fixed(species.weight * particles.rotation[i] / scale_.energy_unit);
      if (gas_->is_vibrating)
        here[momentum() + 5] +=
            SurfaceTally::fixed(species.weight * boltzmann *
                                vibrational_energy(species.vibration, particles.levels[i]) / scale_.energy_unit);
    }
}

void DrivenPatch::end_step(std::span<const std::int64_t> words) {
  for (std::size_t k = 0; k < mean_.size(); ++k)
    mean_[k] += (static_cast<double>(words[k]) - mean_[k]) / condition_.relaxation;
  update();
}

void DrivenPatch::set_means(std::span<const double> means) {
  for (std::size_t k = 0; k < means.size(); ++k)
    if (means[k] < 0 && (k < momentum() || k >= momentum() + 3))
      throw Error("checkpoint: expected numbers of particles and energies at an inlet or outlet, found one below 0");
  mean_.assign(means.begin(), means.end());
  update();
}

void DrivenPatch::update() {
  if (condition_.kind == BoundaryCondition::Kind::outlet) take_gas_of_cells();
  if (condition_.mass_flow > 0)
    enter_at_mass_flow();
  else
    enter_at_pressure();
}

/// Fractions and temperatures of an outlet. Without particles for very long they stay.
void DrivenPatch::take_gas_of_cells() {
  auto& gas = entering_.gas;
  double molecules = 0, mass = 0, degrees = 0;
  for (std::size_t s = 0; s < gas_->species.size(); ++s) {
    const auto& species = gas_->species[s];
    const double n = species.weight * mean_[count(s)];
    molecules += n;
    mass += n * species.mass;
    degrees += n * species.rotational_degrees;
  }
  if (molecules > 1e-100) {
    for (std::size_t s = 0; s < gas_->species.size(); ++s)
      gas.fraction[s] = gas_->species[s].weight * mean_[count(s)] / molecules;
    const auto* p = &mean_[momentum()];
    const Vec3 total = scale_.momentum_unit * Vec3{p[0], p[1], p[2]};
    const double energy = scale_.energy_unit * p[3] - squared_norm(total) / (2 * mass);
    constexpr double coldest = 1e-3;
    gas.temperature = std::max(coldest, energy / (molecules * boltzmann));
    if (degrees > 0) gas.rotational_temperature = scale_.energy_unit * p[4] / (0.5 * degrees * boltzmann);
    if (gas_->is_vibrating) {
      std::vector<double> n;
      for (std::size_t s = 0; s < gas_->species.size(); ++s) n.push_back(gas_->species[s].weight * mean_[count(s)]);
      gas.vibrational_temperature =
          temperature_of_vibration(gas_->vibrations(), n, scale_.energy_unit * p[5] / boltzmann);
    }
  }
  gas.density = condition_.pressure / (boltzmann * gas.temperature);
}

void DrivenPatch::enter_at_pressure() {
  const auto& gas = entering_.gas;
  double net = 0;  // kg per step and F_num
  for (std::size_t s = 0; s < gas_->species.size(); ++s)
    net += gas_->species[s].weight * gas_->species[s].mass * (mean_[out(s)] - mean_[in(s)]);
  const double wanted = -net * scale_.fnum_per_time / (gas.density * mass_of(gas.fraction) * area_);
  entering_.is_limited = wanted > sound();
  entering_.speed = std::clamp(wanted, -max_mach_out * sound(), sound());
  for (std::size_t s = 0; s < gas_->species.size(); ++s)
    entering_.species[s] = {
        molecular_flux(gas.density * gas.fraction[s], gas.temperature, gas_->species[s].mass, entering_.speed),
        entering_.speed};
}

void DrivenPatch::enter_at_mass_flow() {
  auto& gas = entering_.gas;
  const double molecules = condition_.mass_flow / (mass_of(entering_.gas.fraction) * area_);  // net, per m2 and second
  double mass = 0;
  gas.density = entering_.speed = 0;
  entering_.is_limited = false;
  for (std::size_t s = 0; s < gas_->species.size(); ++s) {
    const auto& species = gas_->species[s];
    const double net = molecules * gas.fraction[s];
    const double rate = net + mean_[out(s)] * species.weight * scale_.fnum_per_time / area_;
    const double c = most_probable_speed(gas.temperature, species.mass), high = sound() / c;
    const double ratio = rate > 0 ? ratio_of_share(net / rate, high) : 0;
    entering_.species[s] = {rate, c * ratio};
    entering_.is_limited = entering_.is_limited || ratio >= high;
    gas.density += rate / molecular_flux(1, gas.temperature, species.mass, c * ratio);
    entering_.speed += net * species.mass;
    mass += species.mass * rate / molecular_flux(1, gas.temperature, species.mass, c * ratio);
  }
  entering_.speed /= std::max(mass, 1e-300);
}

double DrivenPatch::mass_of(const std::vector<double>& fraction) const {
  double mass = 0;
  for (std::size_t s = 0; s < fraction.size(); ++s) mass += fraction[s] * gas_->species[s].mass;
  return mass;
}

double DrivenPatch::sound() const {
  const auto& gas = entering_.gas;
  double degrees = 3;
  for (std::size_t s = 0; s < gas.fraction.size(); ++s)
    degrees += gas.fraction[s] * (gas_->species[s].rotational_degrees +
                                  2 * vibrational_heat(gas_->species[s].vibration, gas.temperature));
  return std::sqrt((degrees + 2) / degrees * boltzmann * gas.temperature / mass_of(gas.fraction));
}

}  // namespace pamr::dsmc
