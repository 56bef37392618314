// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/output_file.hpp"
#include "cli/run_tool.hpp"
#include "cli/text_file.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/validate/validate.hpp"
#include "solvers/poisson_boltzmann/electrode_file.hpp"
#include "solvers/poisson_boltzmann/pb_report.hpp"

namespace {

using namespace pamr;
namespace pb = poisson_boltzmann;

struct Options {
  std::string case_file, mesh, output, start, surface, petsc;
  bool force = false;
};

void declare(CLI::App& app, Options& o) {
  app.add_option("CASE", o.case_file, "case file (TOML)")->required();
  app.add_option("--mesh", o.mesh, "mesh to solve on")->required();
  app.add_option("-o,--output", o.output, "mesh to write: the same with the fields of the solution")->required();
  app.add_option("--start", o.start, "nodal field of the mesh to start from: a potential, as a coarser level left it")
      ->type_name("FIELD");
  app.add_option("--surface", o.surface, "write the boundary with potential, charge density and stress, for ParaView")
      ->type_name("FILE.vtu");
  app.add_option("--petsc", o.petsc, "options for PETSc, after those of the case: \"-pc_type hypre -ksp_monitor\"")
      ->type_name("OPTIONS");
  app.add_flag("--force", o.force, cli::force_help);
}

/// Wall and processor time of the parts of the work, on this rank.
class Laps {
 public:
  /// What was done since the last call, or the start, is `part`.
  void end(const std::string& part) {
    const auto wall = std::chrono::steady_clock::now();
    const auto cpu = std::clock();
    wall_[part] = std::chrono::duration<double>(wall - last_wall_).count();
    cpu_[part] = static_cast<double>(cpu - last_cpu_) / CLOCKS_PER_SEC;
    last_wall_ = wall;
    last_cpu_ = cpu;
  }
  /// With the sum of the parts as `total`.
  nlohmann::json wall() const { return with_total(wall_); }
  nlohmann::json cpu() const { return with_total(cpu_); }

 private:
  static nlohmann::json with_total(nlohmann::json parts) {
    double total = 0;
    for (const auto& part : parts) total += part.get<double>();
    parts["total"] = total;
    return parts;
  }

  std::chrono::steady_clock::time_point last_wall_ = std::chrono::steady_clock::now();
  std::clock_t last_cpu_ = std::clock();
  nlohmann::json wall_ = nlohmann::json::object(), cpu_ = nlohmann::json::object();
};

/// Largest resident set of this process so far.
std::int64_t peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{1024} * usage.ru_maxrss;
}

/// u at the nodes from the field that --start names; empty without it. Collective.
std::vector<double> start_of(const par::Comm& comm, const mesh::DistMesh& mesh, const pb::Conditions& conditions,
                             const Options& o) {
  if (o.start.empty()) return {};
  const auto* field = mesh.find_node_field(o.start);
  if (field == nullptr)
    throw Error(fmt::format("{}: expected a field on nodes named \"{}\" to start from, found none", o.mesh, o.start));
  if (field->n_components != 1 || field->holds_integers())
    throw Error(fmt::format("{}: field \"{}\": expected one real component on nodes, found {}", o.mesh, o.start,
                            field->holds_integers() ? std::string("integers") : std::to_string(field->n_components)));
  std::vector<double> u(field->real().begin(), field->real().end());
  bool bad = false;
  for (std::size_t i = 0; i < u.size(); ++i) {
    bad = bad || !std::isfinite(u[i]) || std::abs(u[i]) > pb::largest_potential;
    u[i] -= conditions.psi0[i];
  }
  if (comm.any(bad))
    throw Error(fmt::format("{}: field \"{}\": expected potentials within {:g} kT/Ze, found others", o.mesh, o.start,
                            pb::largest_potential));
  return u;
}

/// What is solved, and the memory that it will take; the latter as it goes to the report. Collective.
nlohmann::json print_case(const cli::Session& session, const pb::Case& problem, const mesh::DistMesh& mesh,
                          const pb::Conditions& conditions) {
  for (const auto& line : pb::describe(problem)) session.summary(line);
  const auto& comm = session.comm();
  const auto memory = pb::memory_needed(mesh, problem);
  const auto n_entries = comm.sum(memory.n_entries), bytes = comm.max(memory.total());
  session.summary(fmt::format(
      "{} nodes, {} cells, {} matrix entries on {} ranks: needs about {:.0f} MB a rank, {:.0f} of them for the mesh",
      mesh.info.n_global_nodes, mesh.info.n_global_cells, n_entries, comm.size(), 1e-6 * static_cast<double>(bytes),
      1e-6 * static_cast<double>(comm.max(memory.mesh))));
  if (conditions.n_contradictions > 0)
    session.warn(fmt::format("{} nodes lie on patches with different potentials; the first of them in the mesh decides",
                             conditions.n_contradictions));
  return {{"matrix_entries", n_entries}, {"bytes_a_rank", bytes}};
}

std::string where_it_failed(const pb::Solution& s) {
  return fmt::format(
      "not converged after {} Newton steps ({}): residual {:.3e} of {:.3e} at the start; largest, {:.3e}, at node {} "
      "({:g}, {:g}, {:g}); nothing is written",
      s.newton_iterations, s.reason, s.residual, s.first_residual, s.worst_residual, s.worst_node, s.worst_point.x,
      s.worst_point.y, s.worst_point.z);
}

cli::ExitCode run(cli::Session& session, const Options& o) {
  session.check_input(o.case_file);
  session.check_input(o.mesh);
  session.check_output(o.output, {o.case_file, o.mesh}, o.force);
  if (!o.surface.empty()) session.check_output(o.surface, {o.case_file, o.mesh, o.output}, o.force);
  const auto& comm = session.comm();
  Laps laps;
  const auto problem = pb::read_case(cli::read_text(comm, o.case_file), o.case_file);
  const pb::PetscRuntime petsc(comm, problem.solver.petsc + " " + o.petsc);
  auto mesh = assemble::assemble(comm, io::read_native(comm, o.mesh, {.build_surfaces = false}));
  validate::require_valid(comm, mesh, o.mesh);
  laps.end("read");

  const auto domain = pb::make_domain(comm, mesh, problem, o.case_file);
  const auto conditions = pb::make_conditions(comm, domain, problem);
  const auto start = start_of(comm, mesh, conditions, o);
  nlohmann::json needs;
  pb::System system(comm, domain, problem, conditions, [&] { needs = print_case(session, problem, mesh, conditions); });
  laps.end("assemble");
  session.summary(pb::table_head());
  const auto solution = system.solve(start, [&](const pb::NewtonStep& step) { session.summary(pb::table_line(step)); });
  laps.end("solve");
  for (const auto& name : petsc.unused_options()) session.warn("no part of PETSc asked for the option " + name);
  if (!solution.converged) {
    session.warn(where_it_failed(solution));
    session.write_report({{"converged", false},
                          {"reason", solution.reason},
                          {"residual", solution.residual},
                          {"newton_iterations", solution.newton_iterations},
                          {"worst_node", solution.worst_node}});
    return cli::ExitCode::failed;
  }

  const auto analysis = pb::analyze(comm, domain, problem, conditions, system, solution);
  laps.end("analyze");
  if (!o.surface.empty()) {
    const auto text = pb::surface_text(comm, domain, problem, conditions, solution, analysis);
    par::agree(comm, [&] {
      if (comm.is_first()) cli::write_whole(o.surface, text);
    });
  }
  auto report = pb::report_of(domain, problem, solution, analysis);
  pb::set_fields(mesh, problem, solution, analysis);
  io::write_native(comm, o.output, mesh);
  laps.end("write");
  report["needs"] = needs;
  report["seconds"] = laps.wall();
  report["cpu_seconds"] = laps.cpu();
  report["peak_rss_bytes"] = comm.max(peak_bytes());
  for (const auto& line : pb::describe_results(problem, analysis)) session.summary(line);
  session.write_report(report);
  session.summary(fmt::format("{} cells, {} Newton steps, {} CG iterations, {:.2f} s -> {}", mesh.info.n_global_cells,
                              solution.newton_iterations, solution.linear_iterations,
                              report["seconds"]["total"].get<double>(), o.output));
  return cli::ExitCode::done;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return cli::run_tool(
      argc, argv,
      {"pamr-pb", "Solves the Poisson-Boltzmann equation round charged bodies.",
       "pamr-mesh --shape kuhn-cube --n 16 -o cube.hdf && pamr-pb cases/plate/cube.toml --mesh cube.hdf -o psi.hdf"},
      [&](CLI::App& app) { declare(app, options); }, [&](cli::Session& session) { return run(session, options); });
}
