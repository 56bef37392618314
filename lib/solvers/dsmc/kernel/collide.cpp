// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/collide.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "pamr/base/memory.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"
#include "solvers/dsmc/kernel/random.hpp"
#include "solvers/dsmc/kernel/vibrate.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

/// A number in (0, 1) with density proportional to x^(a-1) (1-x)^(b-1), for a = 1 or 3/2 and b > 1.
double beta(double a, double b, Random& random) {
  if (a == 1) return 1 - std::pow(random.uniform(), 1 / b);
  const double mode = (a - 1) / (a + b - 2);
  const double top = std::pow(mode, a - 1) * std::pow(1 - mode, b - 1);
  for (;;) {
    const double x = random.uniform();
    if (random.uniform() * top < std::pow(x, a - 1) * std::pow(1 - x, b - 1)) return x;
  }
}

/// Translational temperature of the particles of a cell; 0 for fewer than two.
double temperature_of(const Gas& gas, const Particles& p, std::uint32_t begin, std::uint32_t end) {
  if (end - begin < 2) return 0;
  double weights = 0, mass = 0, energy = 0;
  Vec3 momentum;
  for (auto i = begin; i < end; ++i) {
    const double w = gas.species[p.species[i]].weight, m = w * gas.species[p.species[i]].mass;
    const Vec3 v = p.velocity(i);
    weights += w;
    mass += m;
    momentum = momentum + m * v;
    energy += m * squared_norm(v);
  }
  return (energy - squared_norm(momentum) / mass) / (3 * boltzmann * (weights - weights / (end - begin)));
}

/// Weight of a step in the smoothed temperature of a cell. Vibration relaxes with up to the tenth power of the
/// temperature. What the few molecules of a cell have by chance would bias it by (power) x weight x (2 / 3 N), since
/// those that are fast now would exchange more often.
double part_of_step(const Gas& gas, std::uint64_t step) {
  return gas.is_vibrating ? std::max(0.004, 1 / (static_cast<double>(step) + 1)) : 0.02;
}

/// Chance that one of two colliding molecules exchanges rotational energy, and whether it had to be limited.
struct Exchange {
  double a = 0, b = 0;
  bool is_clamped = false;
};
Exchange exchange_chances(const Gas& gas, std::size_t sa, std::size_t sb, double temperature) {
  constexpr double limit = 0.5;
  const double omega = 1 - gas.pair(sa, sb).exponent;
  const double a = relaxation_probability(gas.rotation, gas.species[sa].rotational_degrees, omega, temperature);
  const double b = relaxation_probability(gas.rotation, gas.species[sb].rotational_degrees, omega, temperature);
  return {std::min(a, limit), std::min(b, limit), a > limit || b > limit};
}

/// The largest chance of an exchange with rotation in a collision of any two molecules.
double max_rotation_chance(const Gas& gas, double temperature) {
  double largest = 0;
  for (std::size_t a = 0; a < gas.species.size(); ++a)
    for (std::size_t b = a; b < gas.species.size(); ++b) {
      const auto chance = exchange_chances(gas, a, b, temperature);
      largest = std::max(largest, chance.a + chance.b);
    }
  return largest;
}

/// The relative velocity after scattering, of length `speed`: isotropic (VHS) or by the law of soft spheres (VSS).
Vec3 scatter(Vec3 g, double speed, double inverse_alpha, Random& random) {
  const double angle = 2 * std::numbers::pi * random.uniform();
  if (inverse_alpha == 1) {
    const double cosine = 2 * random.uniform() - 1, sine = std::sqrt(1 - cosine * cosine);
    return speed * Vec3{cosine, sine * std::cos(angle), sine * std::sin(angle)};
  }
  const double cosine = 2 * std::pow(random.uniform(), inverse_alpha) - 1, sine = std::sqrt(1 - cosine * cosine);
  const double length = norm(g);
  const Vec3 n = length > 0 ? (1 / length) * g : Vec3{1, 0, 0};
  const double ay = std::fabs(n.x) < 0.6 ? 0 : 1;  // any direction well off n
  Vec3 a = cross(n, Vec3{1 - ay, ay, 0});
  a = (1 / norm(a)) * a;
  const Vec3 b = cross(n, a);
  return speed * (cosine * n + sine * (std::cos(angle) * a + std::sin(angle) * b));
}

}  // namespace

void CollisionCounts::add(const CollisionCounts& other) {
  candidates += other.candidates;
  collisions += other.collisions;
  clamped += other.clamped;
}

double draw_remainder(std::uint64_t seed, GlobalId cell, std::uint64_t step) {
  return Random(seed, Purpose::remainder, static_cast<std::uint64_t>(cell), step).uniform_fine();
}

std::vector<CellCollisions> start_collisions(const Gas& gas, double t, std::uint64_t seed,
                                             std::span<const GlobalId> cells) {
  double max_sigma_cr = 0;
  for (const auto& pair : gas.pairs) {
    const double speed = 4 * std::sqrt(2 * boltzmann * t / pair.reduced_mass);
    max_sigma_cr = std::max(max_sigma_cr, pair.weight * section_times_speed(pair, speed * speed));
  }
  std::vector<CellCollisions> state;
  assign_array(state, cells.size(), {max_sigma_cr, 0, 0, 0, 0, 0});
  for (std::size_t c = 0; c < cells.size(); ++c) state[c].remainder = draw_remainder(seed, cells[c], 0);
  return state;
}

Collider::Collider(const Gas& gas, const CollisionOptions& options, std::uint64_t seed)
    : gas_(&gas),
      options_(options),
      seed_(seed),
      of_pair_(gas.pairs.size(), 0),
      bounds_(gas.pairs.begin(), gas.pairs.end()),
      vibration_chance_(gas.is_vibrating ? max_modes * gas.pairs.size() : 0, 0.0) {}

CollisionCounts Collider::collide(const GasDomain& domain, std::uint64_t step, Particles& particles,
                                  std::vector<CellCollisions>& state) {
  counts_ = {};
  if (!options_.enabled) return counts_;
  if (gas_->rotation.model != Rotation::Model::variable) max_exchange_ = max_rotation_chance(*gas_, 0);
  for (std::size_t c = 0; c < state.size(); ++c)
    if (particles.begin()[c + 1] - particles.begin()[c] > 1) collide_cell(domain, c, step, particles, state[c]);
  return counts_;
}

void Collider::collide_cell(const GasDomain& domain, std::size_t c, std::uint64_t step, Particles& particles,
                            CellCollisions& state) {
  const auto begin = particles.begin()[c], end = particles.begin()[c + 1], n = end - begin;
  const bool varies = gas_->is_vibrating || gas_->rotation.model == Rotation::Model::variable;
  if (varies) {
    const double now = temperature_of(*gas_, particles, begin, end);
    const double part = part_of_step(*gas_, step);
    state.temperature = state.temperature > 0 ? state.temperature + part * (now - state.temperature) : now;
  }
  const double wanted = mean_candidates(domain, c, n, state) + state.remainder;
  const auto candidates = static_cast<std::int64_t>(wanted);
  state.remainder = wanted - static_cast<double>(candidates);
  if (candidates == 0) return;

  counts_.candidates += candidates;
  Random random(seed_, Purpose::collision, static_cast<std::uint64_t>(domain.cell_global[c]), step);
  const double bound = state.max_sigma_cr;
  double heaviest = 1;
  if (gas_->is_weighted) {
    heaviest = 0;
    for (auto i = begin; i < end; ++i) heaviest = std::max(heaviest, gas_->species[particles.species[i]].weight);
  }
  has_sub_cells_ = options_.partner == CollisionOptions::Partner::subcell && !gas_->is_weighted &&
                   SubCells::are_worth(n, candidates) && sub_cells_.start(particles, begin, n, domain.volume[c]);
  if (!has_sub_cells_) nearest_.start(particles, begin, n, candidates);
  if (varies) max_exchange_ = max_rotation_chance(*gas_, state.temperature);
  if (gas_->is_vibrating) set_vibration_chances(state.temperature);
  if (max_exchange_ > 0) last_candidate_.assign(n, 0);
  for (std::int64_t k = 0; k < candidates; ++k) {
    const double draw = max_exchange_ > 0 ? random.uniform() : 1;
    const auto first = random.below(n);
    const bool may_exchange = draw < max_exchange_;
    const auto excluded = may_exchange ? last_candidate_[first] : particles.partner[begin + first];
    const auto second = choose_partner(particles, {begin, n}, first, excluded, random);
    const auto a = begin + first, b = begin + second;
    if (may_exchange) {
      last_candidate_[first] = tag_of(particles.id[b]);
      last_candidate_[second] = tag_of(particles.id[a]);
    }
    const double speed_squared = squared_norm(particles.velocity(a) - particles.velocity(b));
    const double threshold = random.uniform() * bound;
    if (!is_accepted(particles.species[a] * gas_->species.size() + particles.species[b], speed_squared, threshold,
                     state.max_sigma_cr))
      continue;
    ++counts_.collisions;
    ++state.collisions;
    state.separation += norm(particles.position(a) - particles.position(b));
    particles.partner[a] = tag_of(particles.id[b]);
    particles.partner[b] = tag_of(particles.id[a]);
    const auto sa = particles.species[a], sb = particles.species[b];
    ++of_pair_[std::min(sa, sb) * gas_->species.size() + std::max(sa, sb)];
    if (gas_->is_weighted) {
      collide_weighted(particles, {a, b, speed_squared, draw}, state, random);
      if (state.energy_deficit != 0) give_back(particles, {begin, n}, heaviest, state.energy_deficit);
    } else {
      collide_pair(particles, {a, b, speed_squared, draw}, state.temperature, random);
    }
  }
}

/// Whether the chance of a pair is greater than the threshold. Raises the maximum to it. The bounds decide when they
/// can, which leaves one pair in hundreds.
bool Collider::is_accepted(std::size_t pair, double speed_squared, double threshold, double& max_sigma_cr) const {
  const auto range = bounds_[pair].of(speed_squared);
  if (range.high <= max_sigma_cr) {
    if (range.high <= threshold) return false;
    if (range.low > threshold) return true;
  }
  const double chance = gas_->pairs[pair].weight * section_times_speed(gas_->pairs[pair], speed_squared);
  max_sigma_cr = std::max(max_sigma_cr, chance);
  return threshold < chance;
}

void Collider::give_back(Particles& p, Rows cell, double heaviest, double& deficit) const {
  constexpr double largest_part = 0.25;  // of the energy about the mean
  const auto for_each = [&](auto&& visit) {
    for (auto i = cell.begin; i < cell.begin + cell.n; ++i)
      if (const auto& species = gas_->species[p.species[i]]; species.weight == heaviest) visit(i, species.mass);
  };
  double mass = 0, energy = 0;
  Vec3 momentum;
  for_each([&](std::uint32_t i, double m) {
    mass += m;
    momentum = momentum + m * p.velocity(i);
  });
  const Vec3 mean = (1 / mass) * momentum;
  for_each([&](std::uint32_t i, double m) { energy += 0.5 * heaviest * m * squared_norm(p.velocity(i) - mean); });
  const double given = std::clamp(deficit, -largest_part * energy, largest_part * energy);
  if (given == 0) return;
  const double factor = std::sqrt(1 + given / energy);
  for_each([&](std::uint32_t i, double) {
    const Vec3 v = mean + factor * (p.velocity(i) - mean);
    p.u[i] = v.x, p.v[i] = v.y, p.w[i] = v.z;
  });
  deficit -= given;
}

void Collider::collide_weighted(Particles& p, Partners partners, CellCollisions& state, Random& random) {
  const auto a = partners.a, b = partners.b;
  const auto& first = gas_->species[p.species[a]];
  const auto& second = gas_->species[p.species[b]];
  if (first.weight == second.weight) {
    collide_pair(p, partners, state.temperature, random);
    return;
  }
  const bool a_is_heavier = first.weight > second.weight;
  const auto& kind = a_is_heavier ? first : second;
  const auto heavy = a_is_heavier ? a : b;
  const double part = (a_is_heavier ? second.weight : first.weight) / kind.weight;
  const Vec3 old = p.velocity(heavy);
  const double old_rotation = p.rotation[heavy];
  const auto old_levels = p.levels_of(heavy);
  collide_pair(p, partners, state.temperature, random);
  const Vec3 change = p.velocity(heavy) - old;
  // part v'^2 + (1 - part) v^2 - (v + part (v' - v))^2 = part (1 - part) (v' - v)^2
  state.energy_deficit += 0.5 * kind.weight * kind.mass * part * (1 - part) * squared_norm(change);
  const Vec3 mean = old + part * change;
  p.u[heavy] = mean.x, p.v[heavy] = mean.y, p.w[heavy] = mean.z;
  p.rotation[heavy] = old_rotation + part * (p.rotation[heavy] - old_rotation);
  if (p.levels_of(heavy) == old_levels) return;
  const double gained = boltzmann * (vibrational_energy(kind.vibration, p.levels[heavy]) -
                                     vibrational_energy(kind.vibration, old_levels));
  const bool stays = random.uniform() >= part;
  if (stays) p.levels[heavy] = old_levels;
  state.energy_deficit += kind.weight * (stays ? part : part - 1) * gained;
}

std::uint32_t Collider::choose_partner(const Particles& p, Rows cell, std::uint32_t first, std::uint32_t excluded,
                                       Random& random) {
  if (options_.partner == CollisionOptions::Partner::any || cell.n == 2) {
    const auto other = random.below(cell.n - 1);
    return other < first ? other : other + 1;
  }
  if (gas_->is_weighted) return choose_weighted_partner(p, cell, first, excluded, random);
  return has_sub_cells_ ? sub_cells_.find(first, excluded, random) : nearest_.find(first, excluded);
}

std::uint32_t Collider::choose_weighted_partner(const Particles& p, Rows cell, std::uint32_t first,
                                                std::uint32_t excluded, Random& random) {
  const auto [begin, n] = cell;
  // Trace particles have nearly always last collided with another species: excluding those alone would bias the rates,
  // so the partner's species is drawn first.
  const auto drawn = random.below(n - 1);
  auto nearest = drawn < first ? drawn : drawn + 1;
  const auto kind = p.species[begin + nearest];
  const Vec3 here = p.position(begin + first);
  double min_distance = std::numeric_limits<double>::infinity();
  for (std::uint32_t k = 0; k < n; ++k) {
    if (k == first || p.species[begin + k] != kind || tag_of(p.id[begin + k]) == excluded) continue;
    const double distance = squared_norm(p.position(begin + k) - here);
    if (distance >= min_distance) continue;
    min_distance = distance;
    nearest = k;
  }
  return nearest;
}

void Collider::set_vibration_chances(double temperature) {
  const auto n = gas_->species.size();
  double largest = 0;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b)
      for (std::size_t i = 0; i < gas_->species[a].vibration.mode.size(); ++i)
        vibration_chance_[(a * n + b) * max_modes + i] = vibration_chance(*gas_, a, b, i, temperature);
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a; b < n; ++b)
      largest = std::max(largest, vibration_chance_of(a, b) + vibration_chance_of(b, a));
  max_exchange_ = std::min(1.0, max_exchange_ + largest);
}

double Collider::vibration_chance_of(std::size_t a, std::size_t b) const {
  if (vibration_chance_.empty()) return 0;
  const auto* chance = vibration_chance_.data() + (a * gas_->species.size() + b) * max_modes;
  double sum = 0;
  for (std::size_t i = 0; i < max_modes; ++i) sum += chance[i];
  return sum;
}

double Collider::exchange_vibration(Particles& p, const Partners& partners, double draw, double motion,
                                    Random& random) {
  const auto sa = p.species[partners.a], sb = p.species[partners.b];
  const double of_a = vibration_chance_of(sa, sb);
  const bool is_a = draw < of_a;
  const auto who = is_a ? partners.a : partners.b;
  const auto& modes = gas_->species[p.species[who]].vibration.mode;
  const auto pair = is_a ? sa * gas_->species.size() + sb : sb * gas_->species.size() + sa;
  double rest = is_a ? draw : draw - of_a;
  std::size_t mode = 0;
  while (mode + 1 < modes.size() && rest >= vibration_chance_[pair * max_modes + mode])
    rest -= vibration_chance_[pair * max_modes + mode++];
  auto& word = p.levels[who];
  const double quantum = boltzmann * modes[mode];
  const double total = motion + quantum * levels::of_mode(word, mode, modes.size());
  const auto level =
      draw_level(total / quantum, gas_->pairs[pair].translational_exponent - 1, levels::highest(modes.size()), random);
  word = levels::with(word, mode, modes.size(), level);
  return std::max(0.0, total - quantum * level);
}

void Collider::collide_pair(Particles& p, const Partners& partners, double temperature, Random& random) {
  const auto [a, b, speed_squared, draw] = partners;
  const auto sa = p.species[a], sb = p.species[b];
  const auto& pair = gas_->pair(sa, sb);
  double speed = std::sqrt(speed_squared);
  if (max_exchange_ > 0) {
    const auto chance = exchange_chances(*gas_, sa, sb, temperature);
    const double vibration = vibration_chance_of(sa, sb) + vibration_chance_of(sb, sa);
    const double all = chance.a + chance.b + vibration;
    const double scaled = all > 1 ? all * draw : draw, rest = scaled - (chance.a + chance.b);
    if (chance.is_clamped || all > 1) ++counts_.clamped;
    if (rest < 0) {
      const bool is_a = scaled < chance.a;
      double& rotation = p.rotation[is_a ? a : b];
      const double total = 0.5 * pair.reduced_mass * speed_squared + rotation;
      const int degrees = gas_->species[is_a ? sa : sb].rotational_degrees;
      rotation = total * beta(0.5 * degrees, pair.translational_exponent, random);
      speed = std::sqrt(2 * (total - rotation) / pair.reduced_mass);
    } else if (rest < vibration) {
      speed = std::sqrt(2 * exchange_vibration(p, partners, rest, 0.5 * pair.reduced_mass * speed_squared, random) /
                        pair.reduced_mass);
    }
  }
  const Vec3 va = p.velocity(a), vb = p.velocity(b);
  const Vec3 center = pair.mass_part_a * va + pair.mass_part_b * vb;
  const Vec3 g = scatter(va - vb, speed, pair.inverse_alpha, random);
  const Vec3 new_a = center + pair.mass_part_b * g, new_b = center - pair.mass_part_a * g;
  p.u[a] = new_a.x, p.v[a] = new_a.y, p.w[a] = new_a.z;
  p.u[b] = new_b.x, p.v[b] = new_b.y, p.w[b] = new_b.z;
}

}  // namespace pamr::dsmc
