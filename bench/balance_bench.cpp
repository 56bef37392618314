// SPDX-License-Identifier: GPL-3.0-or-later
// What each way of balancing gives on a marked mesh, one row each: faces between the parts of the cells before they are
// split, the same over those of compact parts, neighbors, imbalance of the refined mesh, the seconds of the partition
// and of moving the cells by the slowest rank's clock, and whether a second call moves anything again. The first rank
// prints.
//
//     mpirun -n P bench_balance N             W2: a shell of K(N)
//     mpirun -n P bench_balance MESH.hdf      by its field `refine`, if it has one
//     mpirun -n P bench_balance MESH Q...     what Scotch, the curve and runs give for Q parts, on any number of ranks
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <string>

#include "bench/workloads.hpp"
#include "pamr/adapt/flags.hpp"
#include "pamr/adapt/forecast.hpp"
#include "pamr/adapt/read_for_refinement.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/balance/rebalance.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/par/runtime.hpp"

namespace {

using namespace pamr;
using balance::Method;

struct Workload {
  std::string name;
  mesh::DistMesh mesh;                 ///< as `pamr-refine` would read it
  std::vector<std::int64_t> weight{};  ///< cells that each cell becomes
};

Workload load(const par::Comm& comm, const std::string& name) {
  const int n = std::atoi(name.c_str());
  StepTimer timer;
  Workload work{n > 0 ? "W2 of K(" + name + ")" : std::filesystem::path(name).stem().string(),
                n > 0 ? bench::cube(comm, n) : adapt::read_for_refinement(comm, name, {}, timer)};
  auto flags = n > 0 ? bench::mark_shell(work.mesh, 0.35, 0.06)
                     : std::vector<std::uint8_t>(static_cast<std::size_t>(work.mesh.n_cells()), 0);
  if (n == 0 && work.mesh.find_cell_field("refine") != nullptr)
    flags = adapt::flags_from_field(comm, work.mesh, "refine");
  const auto children = adapt::Forecaster(comm, work.mesh).forecast(flags).children;
  work.weight.assign(children.begin(), children.end());
  return work;
}

void print_row(const Workload& work, Rank n_parts, const char* asked, const balance::Report& report,
               const std::string& rest) {
  const auto& q = report.after;
  fmt::print("| {} | {} | {} | {} | {} | {:.2f} | {} | {:.3f} | {} |\n", work.name, n_parts, asked,
             balance::name_of(report.method), q.edge_cut, static_cast<double>(q.edge_cut) / q.compact_cut,
             q.max_neighbors, q.imbalance, rest);
}

/// Moves the cells by that method and once more.
void run(const par::Comm& comm, const Workload& work, Method method, double keep_below, const char* asked) {
  const balance::Options options{.method = method, .keep_below = keep_below};
  mesh::DistMesh copy = work.mesh;
  copy.cell_fields = {{"weight", "", 1, mesh::StorageType::int32, work.weight}};
  copy.node_fields.clear();
  comm.barrier();
  auto first = balance::rebalance(comm, std::move(copy), work.weight, options);
  const auto weight = first.mesh.find_cell_field("weight")->integer();
  const balance::Options asked_again{.method = method, .keep_below = std::max(keep_below, 1.02)};
  const auto again = balance::partition(comm, first.mesh, weight, comm.size(), asked_again);
  const auto& report = first.report;
  const double seconds = comm.max(report.partition_seconds), moving = comm.max(report.migrate_seconds);
  if (comm.is_first())
    print_row(work, comm.size(), asked, report,
              fmt::format("{:.3f} | {:.3f} | {} | {}", seconds, moving, report.moved_cells,
                          again.method == Method::none ? "no" : "yes"));
}

void show_parts(const par::Comm& comm, const Workload& work, Rank n_parts) {
  for (const auto method : {Method::scotch, Method::curve, Method::blocks}) {
    balance::Report report;
    comm.barrier();
    const double start = wall_seconds(), cpu = cpu_seconds();
    const auto parts = balance::partition(comm, work.mesh, work.weight, n_parts, {.method = method, .keep_below = 0});
    const double seconds = comm.max(wall_seconds() - start), busy = comm.max(cpu_seconds() - cpu);
    report.method = parts.method;
    report.after = parts.quality;
    if (comm.is_first())
      print_row(work, n_parts, balance::name_of(method), report, fmt::format("{:.3f} | {:.3f}", seconds, busy));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const par::Runtime runtime(argc, argv);
  const par::Comm comm(MPI_COMM_WORLD);
  const auto work = load(comm, argc > 1 ? argv[1] : "20");
  const bool is_of_ranks = argc <= 2;
  if (comm.is_first() && std::getenv("PAMR_BENCH_NO_HEAD") == nullptr)
    fmt::print("| mesh | parts | asked | given | faces | over compact | neighbors | imbalance | seconds |{}\n{}\n",
               is_of_ranks ? " moving | cells moved | moves again |" : " CPU |",
               is_of_ranks ? "|---|---|---|---|---|---|---|---|---|---|---|---|"
                           : "|---|---|---|---|---|---|---|---|---|---|");
  for (int i = 2; i < argc; ++i) show_parts(comm, work, std::atoi(argv[i]));
  if (!is_of_ranks) return 0;
  run(comm, work, Method::none, 1, "as read");
  run(comm, work, Method::best, 1.05, "auto");
  run(comm, work, Method::scotch, 1.02, "scotch");
  run(comm, work, Method::curve, 0, "curve");
  run(comm, work, Method::blocks, 0, "blocks");
  return 0;
}
