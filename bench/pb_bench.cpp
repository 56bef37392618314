// SPDX-License-Identifier: GPL-3.0-or-later
/// The Poisson-Boltzmann solver step by step: what each rank computes, sends and holds.
///
///     mpirun -n P bench_pb [--arrays] CASE MESH    prints JSON
///
/// With `--arrays` the mesh is taken as a program would hand it over: points, cells and boundary triangles, neighbors
/// to be built (step `topology`); memory then counts from there. What a step computes is its processor time outside of
/// MPI, whoever calls it (mpi_counts.hpp).
#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compare/memory.hpp"
#include "mpi_counts.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/runtime.hpp"
#include "solvers/poisson_boltzmann/fem/preconditioner.hpp"
#include "solvers/poisson_boltzmann/fem/spread_cells.hpp"
#include "solvers/poisson_boltzmann/goals/analysis.hpp"

namespace {

using namespace pamr;
using bench::mpi_counts, bench::MpiCounts;
namespace pb = poisson_boltzmann;

/// Collects the steps; each takes what has happened since the last.
class Steps {
 public:
  explicit Steps(const par::Comm& comm) : comm_(comm) { restart(); }

  void lap(const std::string& name) {
    const double cpu = cpu_seconds() - cpu_, waited = mpi_counts().cpu - before_.cpu;
    const std::vector<std::pair<const char*, double>> values{
        {"cpu", cpu},
        {"compute", cpu - waited},
        {"messages", static_cast<double>(mpi_counts().messages - before_.messages)},
        {"bytes", static_cast<double>(mpi_counts().bytes - before_.bytes)},
        {"reductions", static_cast<double>(mpi_counts().reductions - before_.reductions)}};
    for (const auto& [key, value] : values) json_[name][key] = comm_.all_gather(value);
    restart();
  }
  const nlohmann::json& json() const { return json_; }

 private:
  void restart() {
    cpu_ = cpu_seconds();
    before_ = mpi_counts();
  }
  const par::Comm& comm_;
  double cpu_ = 0;
  MpiCounts before_;
  nlohmann::json json_;
};

std::string text_of(const char* file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

nlohmann::json results_of(const pb::Analysis& analysis) {
  nlohmann::json result;
  for (const auto& patch : analysis.patches) {
    if (patch.charge) result["charge " + patch.name] = *patch.charge;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (patch.volume) result[fmt::format("force {} {}", patch.name, axis)] = (*patch.volume)[axis];
      if (patch.torque) result[fmt::format("torque {} {}", patch.name, axis)] = (*patch.torque)[axis];
    }
  }
  if (analysis.energy) result["energy"] = analysis.energy->total;
  return result;
}

/// Takes the neighbors away and leaves the triangles of the boundary.
void forget_neighbors(mesh::BlockMesh& block) {
  for (std::size_t c = 0; c < block.cell_to_cell.size(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const auto neighbor = block.cell_to_cell[c][slot];
      if (neighbor >= 0) continue;
      auto& triangle = block.boundary.node.emplace_back();
      for (std::size_t k = 0; k < 3; ++k)
        triangle[k] = block.cell_to_node[c][static_cast<std::size_t>(mesh::tet::face_to_corner[slot][k])];
      block.boundary.patch.push_back(static_cast<int>(-neighbor - 1));
    }
  block.cell_to_cell = {};
  block.lineage = {};
  block.cell_origin = {};
  block.cell_fields.clear();
  block.node_fields.clear();
}

void run(const par::Comm& comm, const char* case_file, const char* mesh_file, bool from_arrays) {
  const auto input = pb::read_case(text_of(case_file), case_file);
  const pb::PetscRuntime petsc(comm, "");
  const bool needs_surfaces = !input.estimator.goals.empty() || input.solver.order == 2;
  Steps steps(comm);
  auto block = io::read_native(comm, mesh_file, {.build_surfaces = needs_surfaces});
  if (from_arrays) forget_neighbors(block);
  peer::restart_peak();
  const long before = peer::status_bytes("VmRSS:");
  steps.lap("read");
  auto assembled = assemble::assemble(comm, std::move(block));
  steps.lap("topology");
  auto spread = pb::spread_cells(comm, std::move(assembled), balance::Method::scotch);
  const auto& mesh = spread.mesh;
  steps.lap("balance");
  const auto domain = pb::make_domain(comm, mesh, input, case_file);
  const auto conditions = pb::make_conditions(comm, domain, input);
  const pb::Problem problem(domain, input, conditions);
  steps.lap("domain");
  pb::System system(comm, problem);
  steps.lap("matrix");
  const auto solution = system.solve({}, {});
  if (!solution.converged) throw Error("expected a solution, found none: " + solution.reason);
  steps.lap("solve");
  const long solved = peer::status_bytes("VmHWM:");
  const auto analysis = pb::analyze(comm, problem, system, solution, 1e8);
  steps.lap("analyze");

  nlohmann::json of_rank;
  const auto gather = [&](const char* name, double value) { of_rank[name] = comm.all_gather(value); };
  gather("cells", static_cast<double>(mesh.n_cells()));
  gather("unknowns", static_cast<double>(domain.nodes.n_owned()));
  gather("copies", static_cast<double>(domain.nodes.n_nodes() - domain.nodes.n_owned()));
  gather("neighbors", static_cast<double>(domain.nodes.shared().rank.size()));
  gather("peak_rss_bytes", static_cast<double>(peer::status_bytes("VmHWM:")));
  gather("peak_to_solution_bytes", static_cast<double>(solved));
  gather("bytes_before_topology", static_cast<double>(before));
  const nlohmann::json report{
      {"ranks", comm.size()},
      {"cells", mesh.info.n_global_cells},
      {"nodes", mesh.info.n_global_nodes},
      {"preconditioner", pb::name_of(pb::choose_preconditioner(input.solver, mesh.info.n_global_nodes))},
      {"newton_iterations", solution.newton_iterations},
      {"linear_iterations", solution.linear_iterations},
      {"edge_cut_before", spread.report.before.edge_cut},
      {"edge_cut", spread.report.after.edge_cut},
      {"results", results_of(analysis)},
      {"steps", steps.json()},
      {"of_rank", of_rank}};
  if (comm.is_first()) fmt::print("{}\n", report.dump());
}

}  // namespace

int main(int argc, char** argv) {
  const par::Runtime runtime(argc, argv);
  const bool from_arrays = argc > 1 && std::string_view(argv[1]) == "--arrays";
  if (argc != (from_arrays ? 4 : 3)) {
    fmt::print(stderr, "usage: bench_pb [--arrays] CASE MESH\n");
    return 2;
  }
  const par::Comm comm(MPI_COMM_WORLD);
  try {
    run(comm, argv[argc - 2], argv[argc - 1], from_arrays);
  } catch (const std::exception& error) {
    if (comm.is_first()) fmt::print(stderr, "bench_pb: {}\n", error.what());
    return 1;
  }
  return 0;
}
