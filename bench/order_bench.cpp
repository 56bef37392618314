// SPDX-License-Identifier: GPL-3.0-or-later
// W3 in random order: at every level cells (families as units), nodes and marks are shuffled, then ordered, assembled
// and refined. Prints one Markdown line a level: medians of the repetitions, all ranks together.
//   bench_order N LEVELS [REPETITIONS]      Kuhn cube K(N), cells cut by the sphere r = 0.35
// Run alone or under mpirun.
#include <algorithm>
#include <array>
#include <cstdio>
#include <iostream>
#include <string>

#include "bench/workloads.hpp"
#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/flags.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/order/order_along_curve.hpp"
#include "pamr/par/runtime.hpp"
#include "pamr/validate/validate.hpp"
#include "support/meshes.hpp"

namespace {

using namespace pamr;

constexpr std::size_t n_steps = 4;
constexpr std::array<const char*, n_steps> step_name{"order", "assemble", "refine", "validate"};
using Seconds = std::array<double, n_steps>;

/// Processor seconds of all ranks since the last call.
class Stopwatch {
 public:
  explicit Stopwatch(const par::Comm& comm) : comm_(comm) { lap(); }
  double lap() {
    const auto now = cpu_seconds();
    const auto all = comm_.sum(static_cast<std::int64_t>(1e9 * (now - last_)));
    last_ = cpu_seconds();
    return 1e-9 * static_cast<double>(all);
  }

 private:
  const par::Comm& comm_;
  double last_ = 0;
};

mesh::BlockMesh shuffled(const par::Comm& comm, mesh::DistMesh mesh, const std::vector<std::uint8_t>& flags,
                         std::uint64_t seed) {
  mesh.cell_fields.push_back(
      {"refine", "", 1, mesh::StorageType::int8, std::vector<std::int64_t>(flags.begin(), flags.end())});
  return test::permute(comm, test::cut(comm, test::gather(comm, mesh)), seed);
}

struct Level {
  mesh::DistMesh mesh;
  std::int64_t cells_in = 0;
  Seconds seconds{};
};

Level refine_shuffled(const par::Comm& comm, mesh::BlockMesh block) {
  Level level;
  level.cells_in = block.info.n_global_cells;
  comm.barrier();
  Stopwatch watch(comm);
  if (!order::is_ordered(comm, block)) block = order::order_along_curve(comm, std::move(block)).block;
  level.seconds[0] = watch.lap();
  auto mesh = assemble::assemble(comm, std::move(block));
  const auto flags = adapt::flags_from_field(comm, mesh, "refine");
  mesh.cell_fields.clear();
  level.seconds[1] = watch.lap();
  level.mesh = adapt::refine(comm, mesh, flags, {.parent_field = false, .marks_field = ""}).mesh;
  level.seconds[2] = watch.lap();
  validate::require_valid(comm, mesh, "the ordered mesh");
  level.seconds[3] = watch.lap();
  return level;
}

void print_medians(int number, const Level& last, std::vector<Seconds> runs) {
  const auto median = [&](auto&& value) {
    std::vector<double> values;
    for (const auto& run : runs) values.push_back(value(run));
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
  };
  const auto out = static_cast<double>(last.mesh.info.n_global_cells);
  std::printf("| W3random/level:%d | %ld | %.0f | %.2f | %.2f |", number, last.cells_in, out,
              1e-6 * out / median([](const Seconds& s) { return s[0] + s[2]; }),
              1e-6 * out / median([](const Seconds& s) { return s[0] + s[1] + s[2]; }));
  for (std::size_t i = 0; i < n_steps; ++i)
    std::printf(" %.3f |", 1e6 / static_cast<double>(last.cells_in) * median([i](const Seconds& s) { return s[i]; }));
  std::printf("\n");
  std::fflush(stdout);
}

void run(const par::Comm& comm, int n, int levels, int repetitions) {
  if (comm.is_first()) {
    std::printf("| workload | cells in | cells out | M cells out per CPU s: order + refine | with assemble |");
    for (const auto* step : step_name) std::printf(" %s, us per cell in |", step);
    std::printf("\n|---|---|---|---|---|---|---|---|---|\n");
  }
  auto mesh = bench::cube(comm, n);
  for (int number = 1; number <= levels; ++number) {
    const auto flags = bench::mark_crossing(mesh, 0.35);
    const auto block = shuffled(comm, std::move(mesh), flags, static_cast<std::uint64_t>(number));
    std::vector<Seconds> runs;
    Level level;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
      level = {};
      level = refine_shuffled(comm, block);
      runs.push_back(level.seconds);
    }
    if (comm.is_first()) print_medians(number, level, runs);
    mesh = std::move(level.mesh);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const par::Runtime runtime(argc, argv);
  try {
    if (argc < 3 || argc > 4) throw Error("usage: bench_order N LEVELS [REPETITIONS]");
    const par::Comm comm(MPI_COMM_WORLD);
    run(comm, std::stoi(argv[1]), std::stoi(argv[2]), argc > 3 ? std::stoi(argv[3]) : 5);
  } catch (const Error& error) {
    if (runtime.rank() == 0) std::cerr << error.what() << '\n';
    return 2;
  }
  return 0;
}
