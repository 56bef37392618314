// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/require_feasible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/machine.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

constexpr double max_particles_of_rank = 0x1p31;
constexpr double max_events = 1000;  ///< of one molecule in one step

/// Sums over the volume of the domain.
struct Extent {
  double volume = 0;           ///< m3
  double at_start = 0;         ///< particles
  double passed_a_second = 0;  ///< volume times cells that 1 m/s passes in a time step
};

Extent measure(const par::Comm& comm, const Setup& setup, const mesh::DistMesh& mesh) {
  std::array<par::ExactSum, 3> sums;
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto corner = corners(mesh, setup.unit, cell);
    const double v = volume(corner), dt = setup.cell_dt.empty() ? setup.dt : setup.cell_dt[at(cell)];
    sums[0].add(v);
    sums[2].add(v * dt / std::cbrt(v));
    if (const auto* stream = setup.stream_at_start(corner))
      sums[1].add(stream->density * particles_per_molecule(setup.gas, stream->fraction) * v /
                  (setup.fnum * (dt / setup.dt)));
  }
  const auto total = par::reproducible_sums(comm, sums);
  return {total[0], total[1], total[2]};
}

/// Speed of a fast molecule of any stream or wall.
double fastest(const Setup& setup) {
  double speed = 0, lightest = setup.gas.species.front().mass;
  for (const auto& s : setup.gas.species) lightest = std::min(lightest, s.mass);
  for (const auto& s : setup.stream)
    speed = std::max(speed, norm(s.velocity) + most_probable_speed(s.temperature, lightest));
  for (const auto& p : setup.patch)
    if (p.temperature > 0) speed = std::max(speed, norm(p.velocity) + most_probable_speed(p.temperature, lightest));
  return speed;
}

/// Bytes for each rank if all have the same: the least that a machine can give its ranks.
double memory_of_rank(const par::Comm& comm) {
  const auto id = std::bit_cast<std::int64_t>(machine_id());
  const auto ids = comm.all_gather(id);
  const auto together = static_cast<double>(std::count(ids.begin(), ids.end(), id));
  return comm.min(
      std::min(static_cast<double>(memory_of_machine()) / together, static_cast<double>(memory_of_process())));
}

/// Throws `Error` for a time step in which so much happens that nothing seems to move on.
void require_progress(const Case& c, const Setup& setup, const Plan& plan, const Extent& extent) {
  const double speed = fastest(setup), passed = speed * extent.passed_a_second / extent.volume;
  if (!(passed <= max_events))
    throw Error(
        fmt::format("{}: expected a time step in which a molecule of {:.4g} m/s passes at most {:g} cells on "
                    "average, found {:.4g} cells: a step of {:.2g} s does",
                    c.where, speed, max_events, passed, setup.dt * max_events / passed));
  if (!setup.collisions.enabled || plan.collision_time == 0) return;
  const double collisions = setup.dt / setup.mean_dt_ratio / plan.collision_time;
  if (!(collisions <= max_events))
    throw Error(fmt::format(
        "{}: expected a time step in which a molecule of the free stream collides at most {:g} times, found "
        "{:.4g} times: a step of {:.2g} s does",
        c.where, max_events, collisions, setup.dt * max_events / collisions));
}

}  // namespace

void require_feasible(const par::Comm& comm, const Case& c, const Setup& setup, const mesh::DistMesh& mesh,
                      const Plan& plan) {
  const auto extent = measure(comm, setup, mesh);
  require_progress(c, setup, plan, extent);
  const double ranks = comm.size(), particles = std::max(plan.max_particles(), extent.at_start);
  double densest = 0;
  for (const auto& stream : setup.stream) densest = std::max(densest, stream.density);
  if (const double most = densest * extent.volume / setup.fnum; densest > 0 && !(most >= 1 || particles >= 1))
    throw Error(fmt::format(
        "{}: expected a particle at least, found {:.2g} in a domain full of gas: use a smaller weight", c.where, most));
  const char* advice = "use a greater weight (fewer particles), or more machines";
  if (!(particles / ranks <= max_particles_of_rank))
    throw Error(fmt::format("{}: expected at most {:.4g} particles a rank, found about {:.4g}: {}", c.where,
                            max_particles_of_rank, particles / ranks, advice));
  const double bytes = (plan.bytes + (particles - plan.max_particles()) * plan.particle_bytes) / ranks,
               memory = memory_of_rank(comm);
  if (!(bytes <= memory))
    throw Error(
        fmt::format("{}: expected a computation that fits into {:.4g} GB of memory a rank, found one of {:.4g} GB "
                    "a rank, {:.4g} particles in all: {}",
                    c.where, 1e-9 * memory, 1e-9 * bytes, particles, advice));
}

}  // namespace pamr::dsmc
