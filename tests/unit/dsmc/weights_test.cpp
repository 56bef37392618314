// SPDX-License-Identifier: GPL-3.0-or-later
// Species of unlike weights, and the collision rates of mixtures.
#include <gtest/gtest.h>

#include <cmath>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "solvers/dsmc/flow/flow.hpp"
#include "solvers/dsmc/kernel/collide.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/gases.hpp"

namespace weights_test {

using namespace pamr;
using namespace pamr::dsmc;
using geometry::Vec3;

/// Argon with a part of nitrogen whose particles have a weight of their own.
Gas argon_with_nitrogen(double fraction, double weight) {
  Gas gas;
  gas.species = {{"Ar", 6.63e-26, 4.17e-10, 0.81, 273, 1, 0, 1}, {"N2", 4.65e-26, 4.17e-10, 0.74, 273, 1, 2, weight}};
  gas.fraction = {1 - fraction, fraction};
  prepare(gas);
  return gas;
}

/// Sums over a rank's particles times their weights; what the cells owe counts as energy.
struct Sums {
  Vec3 momentum;
  double energy = 0, energy_deficit = 0, trace_particles = 0, trace_energy = 0;
};
Sums sums_of(const Flow& flow) {
  Sums sums;
  const auto& p = flow.particles;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto& s = flow.setup().gas.species[p.species[i]];
    sums.momentum = sums.momentum + (s.weight * s.mass) * p.velocity(i);
    const double energy = 0.5 * s.mass * squared_norm(p.velocity(i));
    sums.energy += s.weight * (energy + p.rotation[i]);
    if (p.species[i] != 1) continue;
    sums.trace_particles += 1;
    sums.trace_energy += energy;
  }
  for (const auto& cell : flow.collisions) sums.energy_deficit += cell.energy_deficit;
  return sums;
}

/// Rate at which a molecule of one species meets those of another of density n: n <cross section times speed>.
double meeting_rate(const PairData& pair, double n, double t) {
  return n * pair.coefficient * std::pow(2 * boltzmann * t / pair.reduced_mass, pair.exponent) *
         std::tgamma(1.5 + pair.exponent) / std::tgamma(1.5);
}

TEST(Weights, CollisionsKeepMomentumAndEnergyWithWhatIsOwed) {
  const par::Comm alone(MPI_COMM_SELF);
  const auto mesh = assemble::assemble(alone, test::kuhn_cube(alone, 3));
  Flow flow(alone, mesh, test::box_of(argon_with_nitrogen(0.01, 0.01), mesh, 2e-3, 30, 1e22, 400, 100, 2e-7));
  flow.fill(mesh);
  Collider collider(flow.setup().gas, {}, 5);
  const auto before = sums_of(flow);

  double max_deficit = 0;
  std::int64_t of_pair[4] = {};
  for (std::uint64_t step = 0; step < 100; ++step) {
    collider.collide(flow.domain(), step, flow.particles, flow.collisions);
    max_deficit = std::max(max_deficit, sums_of(flow).energy_deficit);
  }
  std::copy_n(collider.collisions_of_pairs().begin(), 4, of_pair);

  const auto after = sums_of(flow);
  const double thermal = std::sqrt(before.energy * 6.63e-26 * static_cast<double>(flow.particles.size()));
  EXPECT_LT(norm(after.momentum - before.momentum) / thermal, 1e-13);
  EXPECT_NEAR((after.energy + after.energy_deficit) / before.energy, 1, 1e-13);
  EXPECT_LT(max_deficit, 1e-6 * before.energy);  // it is given back in the same step
  EXPECT_GT(of_pair[0], 100);
  EXPECT_GT(of_pair[1], 100);
  EXPECT_GT(of_pair[3], 10);
  EXPECT_EQ(of_pair[2], 0);
}

TEST(Weights, AGasAtRestKeepsItsTemperatures) {
  const par::Comm alone(MPI_COMM_SELF);
  const auto mesh = assemble::assemble(alone, test::kuhn_cube(alone, 4));
  Gas gas;
  gas.species = {{"N2", 4.65e-26, 4.17e-10, 0.74, 273, 1, 2, 1}, {"Ar", 6.63e-26, 4.17e-10, 0.81, 273, 1, 0, 0.2}};
  gas.fraction = {0.9, 0.1};
  prepare(gas);
  Flow flow(alone, mesh, test::box_of(gas, mesh, 2e-3, 40, 1e22, 400, 400, 2e-7));
  flow.fill(mesh);
  double moving = 0, rotating = 0;
  const auto& p = flow.particles;
  for (int step = 0; step < 200; ++step) {
    flow.step();
    if (step < 50) continue;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto& s = gas.species[p.species[i]];
      moving += s.weight * 0.5 * s.mass * squared_norm(p.velocity(i)) / 3;  // of each degree of freedom
      if (p.species[i] == 0) rotating += p.rotation[i] / 2 / 0.9;           // as if all molecules had them
    }
  }
  EXPECT_NEAR(rotating / moving, 1, 0.02);
}

TEST(Weights, TraceMoleculesCollideAsOftenAsKineticTheorySays) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 5));
  const double t = 300, n = 1e22, fraction = 0.01;
  const auto gas = argon_with_nitrogen(fraction, 0.02);
  auto setup = test::box_of(gas, mesh, 2e-3, 16, n, t, t, 0);
  setup.dt = 0.3 / meeting_rate(gas.pair(0, 0), n, t);
  Flow flow(comm, mesh, setup);
  flow.fill(mesh);
  const double trace = static_cast<double>(comm.sum(std::llround(sums_of(flow).trace_particles)));
  const double argon = static_cast<double>(flow.n_particles()) - trace;

  constexpr int n_steps = 200;
  for (int step = 0; step < n_steps; ++step) flow.step();

  // Half of the volume's like pairs, all of the unlike ones; one collision stands for as many as the lighter particle.
  const double volume = 8e-9, per = n_steps * setup.dt * setup.fnum / volume;
  const double expected[] = {0.5 * argon * argon * meeting_rate(gas.pair(0, 0), 1, t) * per,
                             argon * trace * meeting_rate(gas.pair(0, 1), 1, t) * per, 0,
                             0.5 * trace * trace * 0.02 * meeting_rate(gas.pair(1, 1), 1, t) * per};
  for (const std::size_t pair : {0, 1, 3}) {
    const auto found = static_cast<double>(comm.sum(flow.collider().collisions_of_pairs()[pair]));
    EXPECT_NEAR(found / expected[pair], 1, 4 / std::sqrt(expected[pair]) + 0.002) << pair << ": " << found;
  }
}

TEST(Weights, MixturesOfLikeWeightsCollideAsOftenAsKineticTheorySays) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 6));
  const double t = 300, n = 1e22;
  const auto gas = argon_with_nitrogen(0.5, 1);
  auto setup = test::box_of(gas, mesh, 2e-3, 24, n, t, t, 0);
  setup.dt = 0.3 / meeting_rate(gas.pair(0, 0), n, t);
  Flow flow(comm, mesh, setup);
  flow.fill(mesh);
  const auto nitrogen = static_cast<double>(comm.sum(std::llround(sums_of(flow).trace_particles)));
  const double argon = static_cast<double>(flow.n_particles()) - nitrogen;

  constexpr int n_steps = 260;
  for (int step = 0; step < n_steps; ++step) flow.step();

  const double per = n_steps * setup.dt * setup.fnum / 8e-9;
  const double unlike = argon * nitrogen * meeting_rate(gas.pair(0, 1), 1, t) * per;
  const auto found = static_cast<double>(comm.sum(flow.collider().collisions_of_pairs()[1]));
  EXPECT_GT(unlike, 64e4);  // so that four standard errors are the bar of half a per cent
  EXPECT_NEAR(found / unlike, 1, 0.005);
}

TEST(Weights, AHotTraceCoolsAsFastAsWithEqualWeights) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 6));
  double t[2][3] = {}, error[3] = {};
  for (const int which : {0, 1}) {
    auto setup = test::box_of(argon_with_nitrogen(0.02, which == 0 ? 1 : 0.05), mesh, 2e-3, 25, 1e22, 300, 300, 5e-8);
    Flow flow(comm, mesh, setup);
    flow.fill(mesh);
    for (std::size_t i = 0; i < flow.particles.size(); ++i)
      if (flow.particles.species[i] == 1)
        for (auto* speeds : {&flow.particles.u, &flow.particles.v, &flow.particles.w}) (*speeds)[i] *= 3;
    for (int at = 0; at < 3; ++at) {
      for (int step = 0; step < 5; ++step) flow.step();
      const auto sums = sums_of(flow);
      const auto n = static_cast<double>(comm.sum(std::llround(sums.trace_particles)));
      t[which][at] = par::reproducible_sum(comm, std::vector<double>{sums.trace_energy}) / (1.5 * boltzmann * n);
      error[at] += 1 / n;
    }
  }

  EXPECT_LT(t[1][0], 2500);
  for (int at = 0; at < 3; ++at)
    EXPECT_NEAR(t[1][at] / t[0][at], 1, 4 * std::sqrt(0.8 * error[at])) << t[0][at] << " and " << t[1][at];
  EXPECT_LT(t[1][2], 0.5 * t[1][0]);
}

TEST(Weights, OfWhichTheGreatestIsNotOneAreRefused) {
  EXPECT_THROW(argon_with_nitrogen(0.1, 0), Error);
  EXPECT_THROW(argon_with_nitrogen(0.1, -1), Error);
  EXPECT_THROW(argon_with_nitrogen(0.1, 2), Error);
}

}  // namespace weights_test
