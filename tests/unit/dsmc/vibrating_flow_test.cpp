// SPDX-License-Identifier: GPL-3.0-or-later
// Gases that vibrate in boxes: relaxation, equilibrium, energy, walls.
#include <gtest/gtest.h>

#include <cmath>

#include "pamr/assemble/assemble.hpp"
#include "solvers/dsmc/flow/flow.hpp"
#include "solvers/dsmc/flow/gas_contents.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"
#include "solvers/dsmc/sampling/cell_flow.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/gases.hpp"

namespace vibrating_flow_test {

using namespace pamr;
using namespace pamr::dsmc;
using geometry::Vec3;

/// Nitrogen that relaxes in `number` collisions at `t`, somewhat more slowly when it is colder.
Gas nitrogen_that_vibrates(double number, double t, std::vector<double> modes = {3371}) {
  auto gas = test::nitrogen();
  gas.species[0].vibration = {std::move(modes), number * std::pow(t, 0.74), 0, 0};
  prepare(gas);
  return gas;
}

/// A box of the kind of `box_of`, its vibration at a temperature of its own, its step a part of the collision time.
Setup box_that_vibrates(const Gas& gas, const mesh::DistMesh& mesh, double per_cell, double t, double vibrational,
                        double part = 0.2) {
  const double n = 1e22;
  auto setup = test::box_of(gas, mesh, 2e-3, per_cell, n, t, t, part / collision_frequency(gas.species[0], n, t));
  setup.stream[0].vibrational_temperature = vibrational;
  return setup;
}

/// Energies of all molecules over their number and Boltzmann's constant, K.
struct Means {
  double n = 0, motion = 0, rotation = 0, vibration = 0;
  double all() const { return motion + rotation + vibration; }
  double t_tr() const { return motion / 1.5; }
};
Means means_of(const Flow& flow) {
  const auto totals = test::totals(flow);
  const auto& p = flow.particles;
  par::ExactSum vibration;
  for (std::size_t i = 0; i < p.size(); ++i)
    vibration.add(vibrational_energy(flow.setup().gas.species[p.species[i]].vibration, p.levels[i]));
  const double per = 1 / (boltzmann * totals.n);
  const double bulk = squared_norm(totals.momentum) / (2 * totals.mass);
  return {totals.n, per * (totals.translational - bulk) * totals.n / (totals.n - 1), per * totals.rotational,
          par::reproducible_sums(flow.comm(), {&vibration, 1}).front() / totals.n};
}

/// The temperature at which 5/2 T and the vibration add up to an energy (K).
double temperature_of(const Vibration& v, double energy) {
  double low = 0, high = energy;
  for (int i = 0; i < 60; ++i) {
    const double t = 0.5 * (low + high);
    (2.5 * t + mean_vibrational_energy(v, t) < energy ? low : high) = t;
  }
  return low;
}

TEST(VibratingFlow, RelaxesAsLandauAndTellerSayFromTheCold) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 8));
  const auto gas = nitrogen_that_vibrates(8, 6000);
  const auto& s = gas.species[0];
  Flow flow(comm, mesh, box_that_vibrates(gas, mesh, 30, 6000, 0));
  flow.fill(mesh);
  const auto before = means_of(flow);
  EXPECT_EQ(before.vibration, 0);
  const double density = before.n * flow.setup().fnum / 8e-9, dt = flow.setup().dt;
  double rotation = before.rotation, vibration = 0;

  for (int step = 1; step <= 60; ++step) {
    flow.step();
    for (int part = 0; part < 20; ++part) {
      const double t = (before.all() - rotation - vibration) / 1.5, zt = 5 - 2 * 0.74;
      const double collisions = dt / 20 * collision_frequency(s, density, t);
      rotation += collisions * 0.2 * zt / (zt + 2) * (t - rotation);
      vibration += collisions / vibration_number(s, t) * (mean_vibrational_energy(s.vibration, t) - vibration);
    }
    if (step % 20 != 0) continue;
    const auto now = means_of(flow);
    const double bar = 4 * 6000 / std::sqrt(now.n) + 0.015 * vibration;  // far from equilibrium the share is 1 % off
    EXPECT_NEAR(now.vibration, vibration, bar) << "after " << step * 0.2 << " collision times";
    EXPECT_NEAR(now.rotation, rotation, bar);
    EXPECT_NEAR(now.all() / before.all(), 1, 1e-5);  // exactly apart from the drift of the gas as a whole
  }
  EXPECT_GT(vibration, 1500);
}

TEST(VibratingFlow, ComesToTheTemperatureThatTheHeatCapacitySays) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 4));
  for (const double t : {1500.0, 4000.0, 15000.0}) {
    const auto gas = nitrogen_that_vibrates(2, t);
    Flow flow(comm, mesh, box_that_vibrates(gas, mesh, 40, t, 0.3 * t, 0.5));
    flow.fill(mesh);
    const auto before = means_of(flow);
    const double end = temperature_of(gas.species[0].vibration, before.all());
    for (int step = 0; step < 80; ++step) flow.step();

    double motion = 0, rotation = 0, vibration = 0;
    constexpr int n_looks = 12;
    for (int look = 0; look < n_looks; ++look) {
      for (int step = 0; step < 8; ++step) flow.step();
      const auto now = means_of(flow);
      motion += now.t_tr() / n_looks;
      rotation += now.rotation / n_looks;
      vibration += now.vibration / n_looks;
    }

    const double error = 4 / std::sqrt(before.n * 0.25 * n_looks);  // looks at 4 collision times are not independent
    EXPECT_NEAR(motion / end, 1, error * std::sqrt(2.0 / 3)) << t;
    EXPECT_NEAR(rotation / end, 1, error) << t;
    const double heat = vibrational_heat(gas.species[0].vibration, end);
    EXPECT_NEAR(vibration, mean_vibrational_energy(gas.species[0].vibration, end), error * std::sqrt(heat) * end) << t;
  }
}

TEST(VibratingFlow, StaysInEquilibriumWithTheLevelsOfBoltzmann) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 4));
  const double t = 5000, x = 3371 / t;
  const auto gas = nitrogen_that_vibrates(3, t);
  Flow flow(comm, mesh, box_that_vibrates(gas, mesh, 40, t, t, 0.5));
  flow.fill(mesh);
  const double here = temperature_of(gas.species[0].vibration, means_of(flow).all());

  constexpr std::size_t n_levels = 8;
  std::vector<std::int64_t> found(n_levels, 0);
  double n = 0;
  constexpr int n_looks = 15;
  for (int look = 0; look < n_looks; ++look) {
    for (int step = 0; step < 12; ++step) flow.step();
    for (const auto word : flow.particles.levels) ++found[std::min<std::size_t>(word, n_levels - 1)];
    n += static_cast<double>(flow.n_particles());
  }
  comm.sum_in_place(found);

  const double q = std::exp(-3371 / here);
  for (std::size_t v = 0; v < n_levels; ++v) {
    const double expected = n * std::pow(q, v) * (v + 1 < n_levels ? 1 - q : 1);
    EXPECT_NEAR(static_cast<double>(found[v]), expected, 4 * 2 * std::sqrt(expected)) << v << " at x = " << x;
  }
}

TEST(VibratingFlow, KeepsMomentumAndEnergyInEveryCollisionWithSeveralModesAndUnlikeWeights) {
  const par::Comm alone(MPI_COMM_SELF);
  const auto mesh = assemble::assemble(alone, test::kuhn_cube(alone, 3));
  auto gas = nitrogen_that_vibrates(2, 3000, {900, 900, 1900, 3400});
  gas.species.push_back({"X", 6e-26, 4e-10, 0.8, 273, 1, 2, 0.1, {{1200}, 500, 0, 0}});
  gas.fraction = {0.7, 0.3};
  prepare(gas);
  auto setup = box_that_vibrates(gas, mesh, 30, 3000, 1000);
  setup.stream[0].fraction = gas.fraction;
  Flow flow(alone, mesh, setup);
  flow.fill(mesh);
  Collider collider(flow.setup().gas, {}, 5);
  const auto energy = [&] {
    const auto& p = flow.particles;
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto& s = gas.species[p.species[i]];
      sum += s.weight * (0.5 * s.mass * squared_norm(p.velocity(i)) + p.rotation[i] +
                         boltzmann * vibrational_energy(s.vibration, p.levels[i]));
    }
    for (const auto& cell : flow.collisions) sum += cell.energy_deficit;
    return sum;
  };
  const double before = energy();
  const auto levels_before = flow.particles.levels;

  for (std::uint64_t step = 0; step < 100; ++step)
    collider.collide(flow.domain(), step, flow.particles, flow.collisions);

  EXPECT_NEAR(energy() / before, 1, 1e-12);
  double owed = 0;
  for (const auto& cell : flow.collisions) owed += std::fabs(cell.energy_deficit);
  EXPECT_LT(owed, 0.03 * before);  // it is given back and does not pile up
  std::size_t n_changed = 0;
  for (std::size_t i = 0; i < levels_before.size(); ++i) n_changed += flow.particles.levels[i] != levels_before[i];
  EXPECT_GT(n_changed, levels_before.size() / 2);
}

TEST(VibratingFlow, TakesTheTemperatureOfItsWallsWithoutCollisionsAndTheBalanceHolds) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 3));
  const auto gas = nitrogen_that_vibrates(10, 3000, {3371, 1000});
  auto setup = box_that_vibrates(gas, mesh, 60, 300, 300);
  setup.collisions.enabled = false;
  setup.dt = 2e-6;
  for (auto& patch : setup.patch) {
    patch.kind = BoundaryCondition::Kind::diffuse;
    patch.temperature = 3000;
  }
  Flow flow(comm, mesh, setup);
  flow.fill(mesh);
  GasBalance balance;
  auto contents = contents_of(flow);
  for (int interval = 0; interval < 4; ++interval) {
    for (int step = 0; step < 10; ++step) flow.step();
    auto now = contents_of(flow);
    balance.add(contents, now, total_fluxes(comm, flow.flux), setup.patch.size(), 0);
    flow.flux.clear();
    contents = std::move(now);
  }

  EXPECT_TRUE(balance.holds()) << balance.energy / GasBalance::allowed;
  const auto temperatures = temperatures_of(contents, flow);
  const double error = 4 / std::sqrt(static_cast<double>(flow.n_particles()));
  ASSERT_TRUE(temperatures.vibrational.has_value());
  EXPECT_NEAR(*temperatures.vibrational / 3000, 1, error);
  EXPECT_NEAR(temperatures.rotational / 3000, 1, error);
  flow.start_sampling();
  flow.step();
  const auto cells = average_cells(flow.domain(), gas, flow.cells, flow.collisions, setup.unit);
  double t_vib = 0, t = 0;
  for (std::size_t c = 0; c < cells.t_vib.size(); ++c) t_vib += cells.t_vib[c], t += cells.t[c];
  const auto n_cells = static_cast<double>(cells.t_vib.size());
  EXPECT_NEAR(t_vib / n_cells / 3000, 1, 0.05);
  EXPECT_NEAR(t / n_cells / 3000, 1, 0.05);
}

}  // namespace vibrating_flow_test
