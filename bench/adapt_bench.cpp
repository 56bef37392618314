// SPDX-License-Identifier: GPL-3.0-or-later
// What it costs to follow a front: a sphere wanders through a Kuhn cube, cells that it cuts are refined down to a
// level, and those that it has left may be coarsened.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "compare/memory.hpp"
#include "pamr/adapt/adapt.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/heap.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/par/runtime.hpp"
#include "pamr/validate/validate.hpp"

namespace {

using namespace pamr;

constexpr double radius = 0.3;

/// Cells cut by the sphere about (x, 0.5, 0.5) are split down to `levels`; what lies a cell's width from it may be
/// coarsened.
std::vector<std::int8_t> flags_of(const mesh::DistMesh& mesh, double x, int levels) {
  std::vector<std::int8_t> flags;
  flags.reserve(at(mesh.n_cells()));
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    double nearest = 1e9, farthest = 0, size = 0;
    const auto points = mesh.points(c);
    for (const auto p : points) {
      const double r = norm(p - geometry::Vec3{x, 0.5, 0.5});
      nearest = std::min(nearest, r);
      farthest = std::max(farthest, r);
      size = std::max(size, norm(p - points[0]));
    }
    const bool is_cut = nearest < radius && farthest > radius;
    const bool is_near = nearest < radius + size && farthest > radius - size;
    flags.push_back(static_cast<std::int8_t>(is_cut && mesh.lineage[at(c)].level() < levels ? 1 : is_near ? 0 : -1));
  }
  return flags;
}

constexpr std::size_t bytes_of_cell = 400;  // of what a step takes on 16 ranks, for `warm_memory`

/// Compute of each step for each cell, all ranks together. Collective.
std::string steps_text(const par::Comm& comm, const std::vector<StepTime>& steps, double cells) {
  std::string text;
  for (const auto& step : steps) {
    const auto nanoseconds = comm.sum(static_cast<std::int64_t>(1e9 * step.compute()));
    text += fmt::format(" {} {:.3f}", step.step, 1e-3 * static_cast<double>(nanoseconds) / cells);
  }
  return text;
}

int run(int n, int levels, int n_steps, double shift, const char* balance) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, n));
  adapt::Options options;
  options.refinement.parent_field = false;
  options.balancing = adapt::balancing_named(balance, "exact");
  double x = 0.4;
  for (int level = 0; level < levels; ++level) {
    const auto flags = flags_of(mesh, x, levels);
    mesh = adapt::adapt(comm, std::move(mesh), flags, options).mesh;
  }
  for (int step = 0; step < n_steps; ++step) {
    x += shift;
    const auto flags = flags_of(mesh, x, levels);
    if (comm.is_first()) peer::warm_memory(bytes_of_cell * at(mesh.info.n_global_cells));
    comm.barrier();
    peer::restart_peak();
    const double cpu = cpu_seconds(), wall = wall_seconds();
    auto result = adapt::adapt(comm, std::move(mesh), flags, options);
    const double seconds = cpu_seconds() - cpu, elapsed = wall_seconds() - wall;
    const auto& [cells_in, cells_out] = std::pair(result.report.cells_in, result.report.cells_out);
    const auto cells = static_cast<double>(std::max(cells_in, cells_out));
    const auto peak = static_cast<double>(comm.sum(std::int64_t{peer::status_bytes("VmHWM:")}));
    double compute = 0;
    for (const auto& s : result.report.steps) compute += s.compute();
    compute = 1e-6 * static_cast<double>(comm.sum(static_cast<std::int64_t>(1e6 * compute)));
    mesh = std::move(result.mesh);
    const auto of_steps = steps_text(comm, result.report.steps, cells);
    if (!comm.is_first()) continue;
    const auto& c = result.coarsening;
    fmt::print(
        "{} -> {} -> {} cells, {} marked, {} octets gone, {} needed, {} closed, {} moved to siblings, {} to "
        "balance: {:.3f} us a cell here, {:.3f} outside of communication on all ranks, {:.2f} s, {:.0f} bytes a "
        "cell;{}\n",
        cells_in, c.cells_between, cells_out, result.report.closure.n_marked, c.octets_gone, c.octets_needed,
        c.families_closed, c.cells_moved, result.report.balance.moved_cells, 1e6 * seconds / cells,
        1e6 * compute / cells, elapsed, peak / cells, of_steps);
  }
  const auto broken = validate::validate(comm, mesh);
  if (comm.is_first())
    for (const auto& violation : broken) fmt::print("broken: {}\n", violation.invariant);
  return broken.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  set_up_heap();
  const par::Runtime runtime(argc, argv);
  if (argc != 5 && argc != 6) {
    fmt::print("Usage: bench_adapt N LEVELS STEPS SHIFT [auto|scotch|curve|blocks|none]\n");
    return 2;
  }
  return run(std::atoi(argv[1]), std::atoi(argv[2]), std::atoi(argv[3]), std::atof(argv[4]),
             argc == 6 ? argv[5] : "auto");
}
