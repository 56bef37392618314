// SPDX-License-Identifier: GPL-3.0-or-later
// Quality and price of balancing: the refined mesh's imbalance and the edge cut by each method, and the seconds of the
// steps, for W2 (a shell of K(n) refined with closure) or for a marked mesh from a file. The first rank prints.
//
//     mpirun -n P bench_balance N
//     mpirun -n P bench_balance MARKED.hdf
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "bench/workloads.hpp"
#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/flags.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/par/equal_work.hpp"
#include "pamr/par/runtime.hpp"

namespace {

using namespace pamr;

struct Workload {
  mesh::DistMesh mesh;
  std::vector<std::uint8_t> flags;
};

Workload load(const par::Comm& comm, const std::string& name) {
  const int n = std::atoi(name.c_str());
  if (n > 0) {
    auto mesh = bench::cube(comm, n);
    auto flags = bench::mark_shell(mesh, 0.35, 0.06);
    return {std::move(mesh), std::move(flags)};
  }
  auto block = io::read_native(comm, name);
  const std::vector<std::int64_t> ones(block.cell_to_node.size(), 1);
  const auto destination = par::runs_of_equal_work(comm, ones, comm.size());
  auto mesh = assemble::assemble(comm, std::move(block), destination);
  auto flags = adapt::flags_from_field(comm, mesh, "refine");
  return {std::move(mesh), std::move(flags)};
}

void run(const par::Comm& comm, const std::string& name, balance::Method method, std::int64_t vertices_per_part) {
  auto work = load(comm, name);
  const refine::Options options{.parent_field = false};
  const adapt::Balancing how{{.method = method, .vertices_per_part = vertices_per_part}, {}, {}};
  comm.barrier();
  const auto result = adapt::refine(comm, std::move(work.mesh), work.flags, options, how);
  const auto& report = result.report;
  const auto& balance = report.balance;
  // processor seconds of all ranks: own work outside of communication, and Scotch with its communication
  const auto sum = [&](double here) {
    return 1e-9 * static_cast<double>(comm.sum(static_cast<std::int64_t>(1e9 * here)));
  };
  double wall = 0, compute = 0, balancing = 0, migrating = 0, scotch = 0;
  for (const auto& s : report.steps) {
    wall += s.wall;
    compute += s.compute();
    if (s.step == "balance") balancing += s.compute();
    if (s.step == "migrate") migrating += s.compute();
    scotch += s.traffic.external_cpu;
  }
  const double longest = comm.max(wall), all = sum(compute), of_balance = sum(balancing), of_migrate = sum(migrating),
               of_scotch = sum(scotch);
  if (comm.is_first())
    fmt::print(
        "| {} | {} | {} | {} | {:.4f} | {:.4f} | {} | {} | {} | {} | {:.2f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} |\n",
        name, comm.size(), balance::name_of(method), vertices_per_part, balance.before.imbalance,
        balance.after.imbalance, balance.before.edge_cut, balance.after.edge_cut, balance.after.max_neighbors,
        balance.moved_cells, longest, all, of_balance, of_migrate, of_scotch);
}

}  // namespace

int main(int argc, char** argv) {
  const par::Runtime runtime(argc, argv);
  const par::Comm comm(MPI_COMM_WORLD);
  const std::string name = argc > 1 ? argv[1] : "20";
  if (comm.is_first())
    fmt::print(
        "| mesh | ranks | method | groups a part | imbalance before | after | cut before | after | neighbors | moved "
        "| "
        "wall s | compute s | of it balance | migrate | Scotch s |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  run(comm, name, balance::Method::none, 0);
  run(comm, name, balance::Method::blocks, 0);
  for (const std::int64_t vertices : {500, 2000}) run(comm, name, balance::Method::scotch, vertices);
  if (argc > 2) run(comm, name, balance::Method::scotch, 0);
  return 0;
}
