// SPDX-License-Identifier: GPL-3.0-or-later
// Speed of the DSMC solver in a box of nitrogen with rotation at rest in equilibrium, mirrors all round, on Kuhn's
// tetrahedra: most probable speed times time step 0.3 cube roots of a cell's volume, 0.07 pair
// collisions a particle and step, nearest partners, sampling every step.
//
//   bench_dsmc [N [STEPS [PER_CELL]]]     cubes along an edge (default 11: 95,832 particles; 24: 995,328), timed steps
//                                         (50) and particles a cell (12; in dense gas before a body several hundred)
//
// Prints particle-steps per second of processor time (user and system, of all ranks), crossings and collisions per
// particle-step, bytes a particle, messages and reductions a step, and the processor time of each rank, with and
// without communication and waiting.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/par/runtime.hpp"
#include "solvers/dsmc/flow/flow.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"

namespace {

using namespace pamr;
using namespace pamr::dsmc;

Setup box(const mesh::DistMesh& mesh, double per_cell) {
  constexpr double temperature = 300;
  Setup setup;
  setup.gas.species = {{"N2", 4.65e-26, 4.17e-10, 0.74, 273, 1, 2}};
  setup.gas.fraction = {1};
  prepare(setup.gas);
  const auto& n2 = setup.gas.species[0];
  const double n_cells = static_cast<double>(mesh.info.n_global_cells);
  setup.dt = 0.3 * std::cbrt(1 / n_cells) / most_probable_speed(temperature, n2.mass);
  const double density = 2 * 0.07 / setup.dt / collision_frequency(n2, 1, temperature);
  setup.stream = {{"gas", density, temperature, temperature, {}, {1}}};
  setup.patch.resize(mesh.info.patches.size());
  setup.fnum = density / (n_cells * per_cell);
  return setup;
}

}  // namespace

int main(int argc, char** argv) {
  const par::Runtime runtime(argc, argv);
  const par::Comm comm(runtime.world());
  const int n = argc > 1 ? std::atoi(argv[1]) : 11, n_steps = argc > 2 ? std::atoi(argv[2]) : 50;
  const double per_cell = argc > 3 ? std::atof(argv[3]) : 12;
  const auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, n));
  Flow flow(comm, mesh, box(mesh, per_cell));
  flow.fill(mesh);
  for (int step = 0; step < 5; ++step) flow.step();
  flow.start_sampling();

  const double start = cpu_seconds();
  std::int64_t crossings = 0, collisions = 0, candidates = 0;
  double compute = 0;
  Traffic traffic;
  for (int step = 0; step < n_steps; ++step) {
    const auto counts = flow.step();
    crossings += counts.moved.crossings;
    collisions += counts.collided.collisions;
    candidates += counts.collided.candidates;
    compute += counts.compute_seconds;
    traffic += counts.traffic;
  }
  const auto cpu = comm.all_gather(cpu_seconds() - start), computing = comm.all_gather(compute);

  double cpu_all = 0;
  for (const double one : cpu) cpu_all += one;
  const double particles = static_cast<double>(flow.n_particles()), particle_steps = particles * n_steps;
  const auto per = [&](std::int64_t count) { return static_cast<double>(comm.sum(count)) / particle_steps; };
  const double bytes = static_cast<double>(comm.sum(static_cast<std::int64_t>(flow.particles.bytes()))) / particles;
  const double crossings_per = per(crossings), collisions_per = per(collisions), candidates_per = per(candidates);
  const auto per_step = [&](std::int64_t count) { return static_cast<double>(count) / n_steps; };
  const double messages = per_step(comm.sum(traffic.messages)), sent = per_step(comm.sum(traffic.bytes));
  const double exchanges = per_step(comm.max(traffic.rounds));
  if (!comm.is_first()) return 0;
  fmt::print("{:.0f} particles, {} cells, {} ranks, {} steps: {:.2f} M particle-steps per CPU second\n", particles,
             mesh.info.n_global_cells, comm.size(), n_steps, particle_steps / cpu_all * 1e-6);
  fmt::print("case: density {} 1/m3, step {} s, weight {}\n", flow.setup().stream[0].density, flow.setup().dt,
             flow.setup().fnum);
  fmt::print(
      "per particle-step: {:.3f} crossings, {:.4f} collisions of {:.3f} candidate pairs; {:.1f} bytes a particle\n",
      crossings_per, collisions_per, candidates_per, bytes);
  fmt::print("per step: {:.2f} exchanges, {:.2f} reductions, {:.1f} messages of {:.0f} bytes in all\n", exchanges,
             per_step(traffic.reductions), messages, sent);
  for (std::size_t r = 0; r < cpu.size(); ++r)
    fmt::print("rank {}: {:.3f} CPU s, {:.3f} of them computing\n", r, cpu[r], computing[r]);
  return 0;
}
