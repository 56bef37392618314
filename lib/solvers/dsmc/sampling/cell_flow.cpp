// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/cell_flow.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/dsmc/gas/kinetic_theory.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

/// Averages of one cell.
struct CellState {
  double count = 0;    ///< particles, summed over the steps
  double weights = 0;  ///< the same, each times its species' weight
  double mass = 0;     ///< kg, of a molecule times its weight, summed alike
  Vec3 velocity;
  double t_tr = 0, t_rot = 0, t_vib = 0, t = 0;
  double degrees = 3;         ///< of motion and rotation
  double vibrating_heat = 0;  ///< of vibration at `t_vib`, over Boltzmann's constant, a molecule
};

/// Adds vibration: a degree of freedom has k T / 2 of its energy at its temperature.
void add_vibration(const Gas& gas, const CellSums* sums, CellState& cell) {
  std::vector<double> n;
  double energy = 0;
  for (std::size_t s = 0; s < gas.species.size(); ++s) {
    n.push_back(gas.species[s].weight * sums[s].n);
    energy += gas.species[s].weight * sums[s].vibration;
  }
  cell.t_vib = temperature_of_vibration(gas.vibrations(), n, energy);
  if (!(cell.t_vib > 0)) return;
  for (std::size_t s = 0; s < n.size(); ++s)
    cell.vibrating_heat += n[s] / cell.weights * vibrational_heat(gas.species[s].vibration, cell.t_vib);
  const double degrees = 2 * energy / (cell.t_vib * cell.weights);
  cell.t = (cell.degrees * cell.t + degrees * cell.t_vib) / (cell.degrees + degrees);
}

CellState state_of(const Gas& gas, const CellSums* sums) {
  CellState cell;
  Vec3 momentum;
  double energy = 0, rotation = 0, rotational_degrees = 0;
  for (std::size_t s = 0; s < gas.species.size(); ++s) {
    const double w = gas.species[s].weight, m = w * gas.species[s].mass;
    cell.count += sums[s].n;
    cell.weights += w * sums[s].n;
    cell.mass += m * sums[s].n;
    momentum = momentum + m * sums[s].velocity;
    energy += m * sums[s].square;
    rotation += w * sums[s].rotation;
    rotational_degrees += gas.species[s].rotational_degrees * w * sums[s].n;
  }
  if (cell.count == 0) return cell;
  cell.velocity = (1 / cell.mass) * momentum;
  const double thermal = std::max(0.0, energy - squared_norm(momentum) / cell.mass);
  if (cell.count > 1) cell.t_tr = thermal / (3 * boltzmann * (cell.weights - cell.weights / cell.count));
  if (rotational_degrees > 0) cell.t_rot = 2 * rotation / (boltzmann * rotational_degrees);
  const double mean_rotational = rotational_degrees / cell.weights;
  cell.degrees = 3 + mean_rotational;
  cell.t = (3 * cell.t_tr + mean_rotational * cell.t_rot) / cell.degrees;
  if (gas.is_vibrating) add_vibration(gas, sums, cell);
  return cell;
}

/// The mean molecule of the mixture found in a cell.
Species mean_of_cell(const Gas& gas, const CellSums* sums, double weights) {
  Gas local = gas;
  for (std::size_t s = 0; s < gas.species.size(); ++s) local.fraction[s] = gas.species[s].weight * sums[s].n / weights;
  return mean_species(local);
}

constexpr double never = 1e30;  ///< mean free path and collision time where there is no gas

CellFlow empty_flow(std::size_t n_cells, const Gas& gas) {
  CellFlow flow;
  for (auto* values : {&flow.density, &flow.mass_density, &flow.t_tr, &flow.t_rot, &flow.t, &flow.mach, &flow.particles,
                       &flow.density_error, &flow.collision_probability, &flow.separation})
    values->resize(n_cells, 0.0);
  for (auto* values : {&flow.collision_time, &flow.mean_free_path, &flow.knudsen}) values->resize(n_cells, never);
  flow.velocity.resize(3 * n_cells, 0.0);
  flow.species_density.assign(gas.species.size(), std::vector<double>(n_cells, 0.0));
  if (gas.is_vibrating) flow.t_vib.resize(n_cells, 0.0);
  return flow;
}

/// Standard error of a cell's density from the blocks; `density` is that of one particle of weight 1.
double density_error(const CellSamples& samples, std::size_t c, double weights, double density) {
  if (samples.blocks < 2) return 0;
  const double b = static_cast<double>(samples.blocks), m = static_cast<double>(samples.steps_in_blocks);
  const double total = weights - samples.block[c];
  const double variance = std::max(0.0, samples.square_of_blocks[c] / b - (total / b) * (total / b)) * b / (b - 1);
  return std::sqrt(variance / b) * b / m * density;
}

}  // namespace

CellFlow average_cells(const GasDomain& domain, const Gas& gas, const CellSamples& samples,
                       const std::vector<CellCollisions>& collisions, double unit) {
  const auto n_cells = domain.volume.size(), n_species = gas.species.size();
  auto flow = empty_flow(n_cells, gas);
  const double steps = static_cast<double>(std::max<std::int64_t>(1, samples.steps));
  for (std::size_t c = 0; c < n_cells; ++c) {
    const auto* sums = samples.sums.data() + c * n_species;
    const auto cell = state_of(gas, sums);
    const double density = domain.fnum[c] / domain.volume[c];
    for (std::size_t s = 0; s < n_species; ++s)
      flow.species_density[s][c] = gas.species[s].weight * sums[s].n / steps * density;
    flow.density_error[c] = density_error(samples, c, cell.weights, density);
    if (cell.count == 0) continue;
    flow.particles[c] = cell.count / steps;
    flow.density[c] = cell.weights / steps * density;
    flow.mass_density[c] = cell.mass / steps * density;
    flow.velocity[3 * c] = cell.velocity.x;
    flow.velocity[3 * c + 1] = cell.velocity.y;
    flow.velocity[3 * c + 2] = cell.velocity.z;
    flow.t_tr[c] = cell.t_tr;
    flow.t_rot[c] = cell.t_rot;
    if (gas.is_vibrating) flow.t_vib[c] = cell.t_vib;
    flow.t[c] = cell.t;
    if (!(cell.t_tr > 0)) continue;
    const auto mean = mean_of_cell(gas, sums, cell.weights);
    const double degrees = cell.degrees + 2 * cell.vibrating_heat, gamma = (degrees + 2) / degrees;
    const double free_path = mean_free_path(mean, flow.density[c], cell.t_tr);
    flow.mach[c] = norm(cell.velocity) / std::sqrt(gamma * boltzmann * std::max(cell.t, 1e-3) / mean.mass);
    flow.mean_free_path[c] = free_path / unit;
    flow.collision_time[c] = 1 / collision_frequency(mean, flow.density[c], cell.t_tr);
    flow.knudsen[c] = free_path / std::cbrt(domain.volume[c]);
    flow.collision_probability[c] = domain.dt[c] / flow.collision_time[c];
    if (collisions[c].collisions > 0)
      flow.separation[c] = collisions[c].separation / static_cast<double>(collisions[c].collisions) / free_path;
  }
  return flow;
}

std::vector<mesh::CellField> to_fields(CellFlow flow, const Gas& gas) {
  std::vector<mesh::CellField> fields;
  const auto add = [&](std::string name, const char* unit, std::vector<double>& values, int n_components = 1) {
    fields.push_back({std::move(name), unit, n_components, mesh::StorageType::float64, std::move(values)});
  };
  add("n", "1/m3", flow.density);
  add("rho", "kg/m3", flow.mass_density);
  add("u", "m/s", flow.velocity, 3);
  add("T_tr", "K", flow.t_tr);
  add("T_rot", "K", flow.t_rot);
  if (gas.is_vibrating) add("T_vib", "K", flow.t_vib);
  add("T", "K", flow.t);
  add("Ma", "1", flow.mach);
  add("tau_c", "s", flow.collision_time);
  add("lambda", "mesh unit", flow.mean_free_path);
  add("Kn_cell", "1", flow.knudsen);
  add("particles", "1", flow.particles);
  add("n_stderr", "1/m3", flow.density_error);
  add("collision_probability", "1", flow.collision_probability);
  add("separation_over_lambda", "1", flow.separation);
  if (!flow.scale.empty()) add("n_scale", "mesh unit", flow.scale);
  if (gas.species.size() > 1)
    for (std::size_t s = 0; s < gas.species.size(); ++s)
      add("n_" + gas.species[s].name, "1/m3", flow.species_density[s]);
  return fields;
}

}  // namespace pamr::dsmc
