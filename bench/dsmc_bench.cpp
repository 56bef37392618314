// SPDX-License-Identifier: GPL-3.0-or-later
// Speed of the DSMC solver in nitrogen with rotation in equilibrium on Kuhn's tetrahedra: in a box at rest, mirrors all
// round, or in a stream through its sides. Most probable speed (in a stream: and its speed) times time step is 0.3 cube
// roots of a cell's volume; 0.07 pair collisions a particle and step, sampling every step.
//
//   bench_dsmc [N [STEPS [PER_CELL [MACH [PARTNER]]]]]
//
//   N         cubes along an edge (default 11: 95,832 particles; 24: 995,328)
//   STEPS     timed steps (50)
//   PER_CELL  particles a cell (12; in dense gas before a body several hundred)
//   MACH      of the stream (0: the box)
//   PARTNER   of collisions: nearest (default), subcell or any
//
// Prints particle-steps per second of processor time (user and system, of all ranks), crossings and collisions per
// particle-step, bytes a particle, messages and reductions a step, what a rank holds, and the processor time of each
// rank, with and without communication and waiting.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
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

Setup gas_in_a_cube(const mesh::DistMesh& mesh, double per_cell, double mach, CollisionOptions::Partner partner) {
  constexpr double temperature = 300;
  Setup setup;
  setup.gas.species = {{"N2", 4.65e-26, 4.17e-10, 0.74, 273, 1, 2}};
  setup.gas.fraction = {1};
  prepare(setup.gas);
  const auto& n2 = setup.gas.species[0];
  const double n_cells = static_cast<double>(mesh.info.n_global_cells);
  setup.dt = 0.3 * std::cbrt(1 / n_cells) / most_probable_speed(temperature, n2.mass);
  const double speed = mach * std::sqrt(1.4 * boltzmann * temperature / n2.mass);
  setup.dt /= 1 + speed / most_probable_speed(temperature, n2.mass);
  const double density = 2 * 0.07 / setup.dt / collision_frequency(n2, 1, temperature);
  setup.stream = {{"gas", density, temperature, temperature, {speed, 0, 0}, {1}}};
  setup.patch.resize(mesh.info.patches.size());
  if (mach > 0)
    for (auto& patch : setup.patch) {
      patch.kind = BoundaryCondition::Kind::inflow;
      patch.stream = 0;
    }
  setup.collisions.partner = partner;
  setup.fnum = density / (n_cells * per_cell);
  return setup;
}

}  // namespace

int main(int argc, char** argv) {
  const par::Runtime runtime(argc, argv);
  const par::Comm comm(runtime.world());
  const int n = argc > 1 ? std::atoi(argv[1]) : 11, n_steps = argc > 2 ? std::atoi(argv[2]) : 50;
  const double per_cell = argc > 3 ? std::atof(argv[3]) : 12, mach = argc > 4 ? std::atof(argv[4]) : 0;
  const std::string partner = argc > 5 ? argv[5] : "nearest";
  using Partner = CollisionOptions::Partner;
  const auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, n));
  Flow flow(comm, mesh,
            gas_in_a_cube(mesh, per_cell, mach,
                          partner == "any"       ? Partner::any
                          : partner == "subcell" ? Partner::subcell
                                                 : Partner::nearest));
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
  const auto memory = comm.all_gather(static_cast<std::int64_t>(peak_resident_bytes()));
  const auto n_halo = static_cast<std::int64_t>(flow.domain().planes.size()) - flow.domain().n_cells();
  const auto halo = comm.all_gather(n_halo), sent_by = comm.all_gather(traffic.bytes),
             messages_by = comm.all_gather(traffic.messages),
             held = comm.all_gather(static_cast<std::int64_t>(flow.particles.size()));
  const auto cpu = comm.all_gather(cpu_seconds() - start), computing = comm.all_gather(compute);

  double cpu_all = 0;
  for (const double one : cpu) cpu_all += one;
  const double particles = static_cast<double>(flow.n_particles()), particle_steps = particles * n_steps;
  const auto all_crossings = comm.sum(crossings), all_collisions = comm.sum(collisions);
  const double bytes = static_cast<double>(comm.sum(static_cast<std::int64_t>(flow.particles.bytes()))) / particles;
  const double crossings_per = static_cast<double>(all_crossings) / particle_steps,
               collisions_per = static_cast<double>(all_collisions) / particle_steps,
               candidates_per = static_cast<double>(comm.sum(candidates)) / particle_steps;
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
  fmt::print("in all: {} crossings, {} collisions\n", all_crossings, all_collisions);
  fmt::print("per step: {:.2f} exchanges, {:.2f} reductions, {:.1f} messages of {:.0f} bytes in all\n", exchanges,
             per_step(traffic.reductions), messages, sent);
  for (std::size_t r = 0; r < cpu.size(); ++r)
    fmt::print(
        "rank {}: {:.3f} CPU s, {:.3f} of them computing; {} particles, {} cells in the halo, {:.1f} messages of "
        "{:.0f} "
        "bytes a step, {:.1f} MB at most\n",
        r, cpu[r], computing[r], held[r], halo[r], per_step(messages_by[r]), per_step(sent_by[r]),
        static_cast<double>(memory[r]) * 1e-6);
  return 0;
}
