// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/sample.hpp"

#include <algorithm>
#include <cmath>

#include "solvers/dsmc/gas/kinetic_theory.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

/// Averages of one cell.
struct CellState {
  double count = 0;      ///< particles, summed over the steps
  double molecules = 0;  ///< the same, each times its weight
  double mass = 0;       ///< of them, kg
  Vec3 velocity;
  double t_tr = 0, t_rot = 0, t = 0;
  double degrees = 3;
};

CellState state_of(const Gas& gas, const CellSums* sums) {
  CellState cell;
  Vec3 momentum;
  double energy = 0, rotation = 0, rotational_degrees = 0;
  for (std::size_t s = 0; s < gas.species.size(); ++s) {
    const double w = gas.species[s].weight, m = w * gas.species[s].mass;
    cell.count += sums[s].n;
    cell.molecules += w * sums[s].n;
    cell.mass += m * sums[s].n;
    momentum = momentum + m * sums[s].velocity;
    energy += m * sums[s].square;
    rotation += w * sums[s].rotation;
    rotational_degrees += gas.species[s].rotational_degrees * w * sums[s].n;
  }
  if (cell.count == 0) return cell;
  cell.velocity = (1 / cell.mass) * momentum;
  const double thermal = std::max(0.0, energy - squared_norm(momentum) / cell.mass);
  if (cell.count > 1) cell.t_tr = thermal / (3 * boltzmann * (cell.molecules - cell.molecules / cell.count));
  if (rotational_degrees > 0) cell.t_rot = 2 * rotation / (boltzmann * rotational_degrees);
  const double mean_rotational = rotational_degrees / cell.molecules;
  cell.degrees = 3 + mean_rotational;
  cell.t = (3 * cell.t_tr + mean_rotational * cell.t_rot) / cell.degrees;
  return cell;
}

/// The gas with the species in the parts found in a cell.
Species mean_of_cell(const Gas& gas, const CellSums* sums, double molecules) {
  Gas local = gas;
  for (std::size_t s = 0; s < gas.species.size(); ++s)
    local.fraction[s] = gas.species[s].weight * sums[s].n / molecules;
  return mean_species(local);
}

}  // namespace

void CellSamples::clear(std::size_t n_cells, const Gas& gas) {
  *this = {};
  sums.resize(n_cells * gas.species.size());
  block.resize(n_cells);
  square_of_blocks.resize(n_cells);
}

void CellSamples::add(const Particles& p, const Gas& gas) {
  const auto n_species = gas.species.size();
  ++steps;
  ++steps_in_block;
  const auto begin = p.begin();
  for (std::size_t c = 0; c < block.size(); ++c) {
    const auto first = begin[c], last = begin[c + 1];
    if (!gas.is_weighted) block[c] += last - first;
    if (n_species == 1) {
      CellSums here;
      for (auto i = first; i < last; ++i) {
        const Vec3 v = p.velocity(i);
        here.velocity = here.velocity + v;
        here.square += squared_norm(v);
        here.rotation += p.rotation[i];
      }
      auto& sum = sums[c];
      sum.n += last - first;
      sum.velocity = sum.velocity + here.velocity;
      sum.square += here.square;
      sum.rotation += here.rotation;
      continue;
    }
    for (auto i = first; i < last; ++i) {
      auto& sum = sums[c * n_species + p.species[i]];
      const Vec3 v = p.velocity(i);
      sum.n += 1;
      sum.velocity = sum.velocity + v;
      sum.square += squared_norm(v);
      sum.rotation += p.rotation[i];
      if (gas.is_weighted) block[c] += gas.species[p.species[i]].weight;
    }
  }
}

void CellSamples::end_block() {
  if (steps_in_block == 0) return;
  for (std::size_t c = 0; c < block.size(); ++c) {
    square_of_blocks[c] += block[c] * block[c];
    block[c] = 0;
  }
  ++blocks;
  steps_in_blocks += steps_in_block;
  steps_in_block = 0;
}

std::vector<CellQuantity> flow_fields(const Domain& domain, const Gas& gas, const CellSamples& samples,
                                      const std::vector<CellCollisions>& collisions, double unit) {
  const auto n_cells = domain.volume.size(), n_species = gas.species.size();
  const auto make = [&](const char* name, const char* units, int width = 1) {
    return CellQuantity{name, units, width, std::vector<double>(n_cells * static_cast<std::size_t>(width), 0.0)};
  };
  constexpr double never = 1e30;
  auto n = make("n", "1/m3"), rho = make("rho", "kg/m3"), u = make("u", "m/s", 3), t_tr = make("T_tr", "K"),
       t_rot = make("T_rot", "K"), t = make("T", "K"), ma = make("Ma", "1"), lambda = make("lambda", "mesh unit"),
       tau = make("tau_c", "s"), kn = make("Kn_cell", "1"), particles = make("particles", "1"),
       error = make("n_stderr", "1/m3"), probability = make("collision_probability", "1"),
       separation = make("separation_over_lambda", "1");
  std::vector<CellQuantity> parts;
  for (const auto& species : gas.species) parts.push_back(make(("n_" + species.name).c_str(), "1/m3"));

  const double steps = static_cast<double>(std::max<std::int64_t>(1, samples.steps));
  for (std::size_t c = 0; c < n_cells; ++c) {
    const auto* sums = samples.sums.data() + c * n_species;
    const auto cell = state_of(gas, sums);
    const double density = domain.molecules[c] / domain.volume[c];
    lambda.value[c] = tau.value[c] = kn.value[c] = never;
    for (std::size_t s = 0; s < n_species; ++s) parts[s].value[c] = gas.species[s].weight * sums[s].n / steps * density;
    if (samples.blocks > 1) {
      const double b = static_cast<double>(samples.blocks), m = static_cast<double>(samples.steps_in_blocks);
      const double total = cell.molecules - samples.block[c];
      const double variance = std::max(0.0, samples.square_of_blocks[c] / b - (total / b) * (total / b)) * b / (b - 1);
      error.value[c] = std::sqrt(variance / b) * b / m * density;
    }
    if (cell.count == 0) continue;
    particles.value[c] = cell.count / steps;
    n.value[c] = cell.molecules / steps * density;
    rho.value[c] = cell.mass / steps * density;
    u.value[3 * c] = cell.velocity.x;
    u.value[3 * c + 1] = cell.velocity.y;
    u.value[3 * c + 2] = cell.velocity.z;
    t_tr.value[c] = cell.t_tr;
    t_rot.value[c] = cell.t_rot;
    t.value[c] = cell.t;
    if (!(cell.t_tr > 0)) continue;
    const auto mean = mean_of_cell(gas, sums, cell.molecules);
    const double gamma = (cell.degrees + 2) / cell.degrees;
    const double free_path = mean_free_path(mean, n.value[c], cell.t_tr);
    ma.value[c] = norm(cell.velocity) / std::sqrt(gamma * boltzmann * std::max(cell.t, 1e-3) / mean.mass);
    lambda.value[c] = free_path / unit;
    tau.value[c] = 1 / collision_frequency(mean, n.value[c], cell.t_tr);
    kn.value[c] = free_path / std::cbrt(domain.volume[c]);
    probability.value[c] = domain.dt[c] / tau.value[c];
    if (collisions[c].collisions > 0)
      separation.value[c] = collisions[c].separation / static_cast<double>(collisions[c].collisions) / free_path;
  }
  std::vector<CellQuantity> fields{n,   rho,    u,  t_tr,      t_rot, t,           ma,
                                   tau, lambda, kn, particles, error, probability, separation};
  if (n_species > 1) fields.insert(fields.end(), parts.begin(), parts.end());
  return fields;
}

}  // namespace pamr::dsmc
