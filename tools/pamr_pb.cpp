// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/run_tool.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/counted.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/validate/validate.hpp"
#include "solvers/poisson_boltzmann/fem/initial_guess.hpp"
#include "solvers/poisson_boltzmann/fem/preconditioner.hpp"
#include "solvers/poisson_boltzmann/fem/spread_cells.hpp"
#include "solvers/poisson_boltzmann/problem/case_names.hpp"
#include "solvers/poisson_boltzmann/report/electrode_file.hpp"
#include "solvers/poisson_boltzmann/report/pb_report.hpp"

namespace {

using namespace pamr;
namespace pb = poisson_boltzmann;

struct Options {
  std::string case_file, mesh, output, start, surface, petsc, balance = "scotch";
  int format = io::newest_format;
  std::int64_t max_cells = 100'000'000;
  bool force = false;
};

void declare(cli::CommandLine& line, Options& o) {
  line.option("CASE", o.case_file, "case file (TOML)").required();
  line.option("--mesh", o.mesh, "mesh to solve on").required();
  line.option("-o,--output", o.output, "mesh to write: the same with the fields of the solution").required();
  line.option("--start", o.start, "nodal field of the mesh to start from: a potential, as a coarser level left it")
      .type_name("FIELD");
  line.option("--surface", o.surface, "write the boundary with potential, charge density and stress, for ParaView")
      .type_name("FILE.vtu");
  line.option("--petsc", o.petsc, "options for PETSc, after those of the case: \"-pc_type hypre -ksp_monitor\"")
      .type_name("OPTIONS");
  line.option("--balance", o.balance, "how the cells, and with them the unknowns, are spread over the ranks")
      .one_of({"auto", "scotch", "curve", "blocks", "none"})
      .show_default();
  line.option("--format", o.format, cli::format_help).range(io::oldest_format, io::newest_format).show_default();
  line.option("--max-cells", o.max_cells,
              "cells of the largest mesh that you would make; no charge is given where its layer would take more")
      .positive();
  line.flag("--force", o.force, cli::force_help);
}

nlohmann::json report_of(const balance::Report& report) {
  return {{"method", balance::name_of(report.method)},
          {"imbalance_before", report.before.imbalance},
          {"imbalance_after", report.after.imbalance},
          {"edge_cut_before", report.before.edge_cut},
          {"edge_cut_after", report.after.edge_cut}};
}

/// Prints what is solved and the memory that it will take; returns the latter for the report. Collective.
nlohmann::json print_case(const cli::Session& session, const pb::Problem& problem) {
  for (const auto& line : pb::describe(problem.input)) session.summary(line);
  const auto& comm = session.comm();
  const auto& mesh = *problem.domain.mesh;
  const auto memory = pb::memory_needed(mesh, problem.input);
  const auto n_entries = comm.sum(memory.n_entries), bytes = comm.max(memory.total());
  session.summary(fmt::format(
      "{} nodes, {} cells, {} matrix entries on {} ranks: needs about {:.0f} MB a rank, {:.0f} of them for the mesh",
      mesh.info.n_global_nodes, mesh.info.n_global_cells, n_entries, comm.size(), 1e-6 * static_cast<double>(bytes),
      1e-6 * static_cast<double>(comm.max(memory.mesh))));
  if (const auto* elements = problem.domain.quadratic.get()) {
    const auto& report = elements->report;
    session.summary(fmt::format("second order: {} unknowns, {} of {} edges curved", elements->n_global_nodes,
                                report.n_curved_edges, report.n_edges));
    if (report.straightening.n_edges > 0)
      session.warn(
          fmt::format("{} would fold or nearly so with curved edges: {} straighter than the surfaces, by up to "
                      "{:.3g} length units; refine the mesh there",
                      counted(report.straightening.n_cells, "cell", "cells"),
                      counted(report.straightening.n_edges, "edge is", "edges are"), report.max_off_surface));
  }
  if (problem.conditions.n_contradictions > 0)
    session.warn(fmt::format("{} on patches with different potentials; the first of them in the mesh decides",
                             counted(problem.conditions.n_contradictions, "node lies", "nodes lie")));
  return {{"matrix_entries", n_entries}, {"bytes_a_rank", bytes}};
}

cli::ExitCode run(cli::Session& session, const Options& o) {
  const auto text = session.read_case(o.case_file);
  session.check_input(o.mesh);
  session.check_native_output(o.output, o.force);
  if (!o.surface.empty()) session.check_output(o.surface, o.force);
  const auto& comm = session.comm();
  StepTimer timer;
  const auto stated = pb::read_case(text, o.case_file);
  const pb::PetscRuntime petsc(comm, stated.solver.petsc + " " + o.petsc);
  session.step("reading " + o.mesh);
  auto mesh = assemble::assemble(
      comm, io::read_native(comm, o.mesh,
                            {.build_surfaces = !stated.estimator.goals.empty() || stated.solver.order == 2,
                             .remark = session.remarks()}));
  validate::require_valid(comm, mesh, o.mesh);
  const auto input = pb::resolve_names(stated, mesh.info.patches, o.case_file);
  timer.lap("read");
  const auto method = balance::method_named(o.balance);
  if (const auto line = balance::what_stands_in(method); !line.empty()) session.note(line);
  session.step("spreading the cells over the ranks");
  auto spread = pb::spread_cells(comm, std::move(mesh), method);
  mesh = std::move(spread.mesh);
  timer.lap("balance");

  session.step(fmt::format("assembling {} cells", mesh.info.n_global_cells));
  const auto domain = pb::make_domain(comm, mesh, input, o.case_file);
  const auto conditions = pb::make_conditions(comm, domain, input);
  const pb::Problem problem(domain, input, conditions);
  pb::require_goals(comm, problem);
  std::vector<double> start;
  if (!o.start.empty()) start = pb::initial_guess(comm, mesh, conditions, o.start, o.mesh);
  if (!start.empty() && domain.quadratic) start = pb::on_all_nodes(domain, start);
  nlohmann::json needs;
  pb::System system(comm, problem, [&] { needs = print_case(session, problem); });
  timer.lap("assemble");
  session.summary(pb::table_head());
  session.step("solving: Newton step 1");
  const auto solution = system.solve(start, [&, n = 1](const pb::NewtonStep& step) mutable {
    session.summary(pb::table_line(step));
    session.step(fmt::format("solving: Newton step {}", ++n));
  });
  timer.lap("solve");
  for (const auto& name : petsc.unused_options()) session.warn("no part of PETSc asked for the option " + name);
  if (!solution.converged) {
    session.warn(pb::describe_failure(solution));
    session.write_report(pb::failure_report(solution));
    return cli::ExitCode::failed;
  }

  session.step("estimating errors and forces");
  const auto analysis = pb::analyze(comm, problem, system, solution, static_cast<double>(o.max_cells));
  timer.lap("analyze");
  if (!analysis.is_finite()) {
    session.warn("a force, a charge or an estimate is beyond floating point; nothing is written");
    session.write_report({{"converged", true}, {"reason", "a result is no number"}});
    return cli::ExitCode::failed;
  }
  if (!o.surface.empty()) pb::write_electrodes(comm, o.surface, problem, solution, analysis);
  auto report = pb::report_of(domain, input, solution, analysis);
  pb::set_fields(mesh, input, solution, analysis);
  session.step("writing " + o.output);
  io::write_native(comm, o.output, mesh, {.format = o.format, .remark = session.remarks()});
  timer.lap("write");
  report["needs"] = needs;
  report["balance"] = report_of(spread.report);
  report["preconditioner"] = pb::name_of(pb::choose_preconditioner(input.solver, mesh.info.n_global_nodes));
  report["seconds"] = pb::seconds_of(timer.steps(), &StepTime::wall);
  report["cpu_seconds"] = pb::seconds_of(timer.steps(), &StepTime::cpu);
  report["peak_rss_bytes"] = comm.max(static_cast<std::int64_t>(peak_resident_bytes()));
  for (const auto& line : pb::describe_layers(input, analysis)) session.warn(line);
  for (const auto& line : pb::describe_results(input, analysis)) session.summary(line);
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
      {"pamr-pb", "Solves the Poisson-Boltzmann equation around charged bodies.",
       "pamr-mesh --shape kuhn-cube --n 16 -o cube.hdf && pamr-pb cases/plate/cube.toml --mesh cube.hdf -o psi.hdf"},
      [&](cli::CommandLine& line) { declare(line, options); },
      [&](cli::Session& session) { return run(session, options); });
}
