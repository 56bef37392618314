// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/output_file.hpp"
#include "cli/run_tool.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/counted.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/mesh/lineage.hpp"
#include "pamr/validate/validate.hpp"
#include "pb/next_level.hpp"
#include "solvers/poisson_boltzmann/fem/initial_guess.hpp"
#include "solvers/poisson_boltzmann/fem/preconditioner.hpp"
#include "solvers/poisson_boltzmann/fem/sheets.hpp"
#include "solvers/poisson_boltzmann/fem/spread_cells.hpp"
#include "solvers/poisson_boltzmann/problem/case_names.hpp"
#include "solvers/poisson_boltzmann/problem/petsc_options.hpp"
#include "solvers/poisson_boltzmann/report/electrode_file.hpp"
#include "solvers/poisson_boltzmann/report/level_plot.hpp"
#include "solvers/poisson_boltzmann/report/pb_report.hpp"

namespace {

using namespace pamr;
namespace pb = poisson_boltzmann;

struct Options {
  std::string case_file, mesh, output, start, surface, history, plot, petsc, balance = "scotch";
  int format = io::newest_format;
  std::int64_t max_cells = 100'000'000;
  int levels = 0;
  double tolerance = 0;
  bool force = false;
};

void declare(cli::CommandLine& line, Options& o) {
  line.option("CASE", o.case_file, "case file (TOML)").required();
  line.option("--mesh", o.mesh, "mesh to solve on").required();
  line.option("-o,--output", o.output, "mesh to write: the same with the fields of the solution").required();
  line.option("--start", o.start, "nodal field of the mesh to start from: a potential, as a coarser level left it")
      .type_name("FIELD");
  line.option("--surface", o.surface, "write the boundary with potential, charge density and stress, for ParaView")
      .file_ending(".vtu");
  line.option("--petsc", o.petsc, "options for PETSc, after those of the case: \"-pc_type hypre -ksp_monitor\"")
      .type_name("OPTIONS");
  line.option("--balance", o.balance, "how the cells, and with them the unknowns, are spread over the ranks")
      .one_of({"auto", "scotch", "curve", "blocks", "none"})
      .show_default();
  line.option("--format", o.format, cli::format_help).range(io::oldest_format, io::newest_format).show_default();
  line.flag("--force", o.force, cli::force_help);
  line.group("Levels", "pamr-pb case.toml --mesh level0.hdf -o out.hdf --levels 4 --tolerance 0.01 --plot levels.svg");
  line.option("--levels", o.levels,
              "refine where the error estimate says, and solve again, N times at most; OUT has the last level")
      .type_name("N")
      .range(0, mesh::max_level);
  line.option("--tolerance", o.tolerance,
              "with --levels: end where the error bar of every goal is at most this part of its value")
      .positive();
  line.option("--history", o.history, "values, error bars and cells of each level").file_ending(".csv");
  line.option("--plot", o.plot, "the same as a picture: values with error bars over cells").file_ending(".svg");
  line.option(
          "--max-cells", o.max_cells,
          "cells of the largest mesh that you would make: with --levels that is made, and no charge is given where its "
          "layer would take more")
      .positive();
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
    session.warn(
        fmt::format("{} on patches with different potentials; the first of them in the mesh decides, and their "
                    "charges and the energy grow with each refinement",
                    counted(problem.conditions.n_contradictions, "node lies", "nodes lie")));
  return {{"matrix_entries", n_entries}, {"bytes_a_rank", bytes}};
}

/// A run over all its levels.
struct Run {
  cli::Session& session;
  const Options& options;
  const pb::PetscRuntime& petsc;
  pb::Case input;
  StepTimer timer;
  std::vector<pb::Level> levels;  ///< that have been solved
};

/// One level: the mesh with the fields of its solution, lines to print, and the report without times; no mesh where the
/// solve has failed.
struct Solved {
  std::optional<mesh::DistMesh> mesh;
  nlohmann::json report;
  std::vector<std::string> warnings, results;
  int newton_iterations = 0, linear_iterations = 0;
};

std::string kept(const Run& run) {
  return run.levels.empty() ? "; nothing is written"
                            : fmt::format("; {} has level {}", run.options.output, run.levels.size() - 1);
}

/// Solves on one mesh, `start` naming the field to start from, and adds the level. Collective.
Solved solve_level(Run& run, mesh::DistMesh given, const std::string& start_field) {
  const auto& session = run.session;
  const auto& o = run.options;
  const auto& input = run.input;
  const auto& comm = session.comm();
  auto& timer = run.timer;
  session.step("spreading the cells over the ranks");
  auto spread = pb::spread_cells(comm, std::move(given), balance::method_named(o.balance));
  auto& mesh = spread.mesh;
  timer.lap("balance");

  session.step(fmt::format("assembling {} cells", mesh.info.n_global_cells));
  const auto domain = pb::make_domain(comm, mesh, input, o.case_file);
  const auto conditions = pb::make_conditions(comm, domain, input);
  const pb::Problem problem(domain, input, conditions);
  pb::require_goals(comm, problem);
  std::vector<double> start;
  if (!start_field.empty()) start = pb::initial_guess(comm, mesh, conditions, start_field, o.mesh);
  if (!start.empty() && domain.quadratic) start = pb::on_all_nodes(domain, start);
  nlohmann::json needs;
  pb::System system(comm, problem, [&] {
    if (run.levels.empty())
      for (const auto& line : pb::describe(input)) session.summary(line);
    needs = print_case(session, problem);
  });
  timer.lap("assemble");
  session.summary(pb::table_head());
  session.step("solving: Newton step 1");
  const auto solution = system.solve(start, [&, n = 1](const pb::NewtonStep& step) mutable {
    session.summary(pb::table_line(step));
    session.step(fmt::format("solving: Newton step {}", ++n));
  });
  timer.lap("solve");
  if (run.levels.empty())
    for (const auto& name : run.petsc.unused_options()) session.warn("no part of PETSc asked for the option " + name);
  if (!solution.converged) {
    session.warn(pb::describe_failure(solution) + kept(run));
    return {std::nullopt, pb::failure_report(solution), {}, {}};
  }

  session.step("estimating errors and forces");
  const auto analysis = pb::analyze(comm, problem, system, solution, static_cast<double>(o.max_cells));
  timer.lap("analyze");
  if (!analysis.is_finite()) {
    session.warn("a force, a charge or an estimate is beyond floating point" + kept(run));
    return {std::nullopt, {{"converged", true}, {"reason", "a result is no number"}}, {}, {}};
  }
  if (!o.surface.empty()) pb::write_electrodes(comm, o.surface, problem, solution, analysis);
  Solved solved{std::nullopt,
                pb::report_of(domain, input, solution, analysis),
                pb::describe_layers(input, analysis),
                pb::describe_results(input, analysis),
                solution.newton_iterations,
                solution.linear_iterations};
  run.levels.push_back(pb::level_of(domain, input, analysis));
  solved.report["needs"] = needs;
  solved.report["balance"] = report_of(spread.report);
  solved.report["preconditioner"] = pb::name_of(pb::choose_preconditioner(input.solver, mesh.info.n_global_nodes));
  pb::set_fields(mesh, input, solution, analysis);
  solved.mesh = std::move(mesh);
  return solved;
}

/// Writes a level over the one before. Collective.
void write_level(Run& run, const mesh::DistMesh& mesh) {
  const auto& o = run.options;
  const auto& comm = run.session.comm();
  run.session.step("writing " + o.output);
  io::write_native(comm, o.output, mesh, {.format = o.format, .remark = run.session.remarks()});
  if (!o.history.empty()) cli::write_whole(comm, o.history, pb::levels_csv(run.levels));
  if (!o.plot.empty()) cli::write_whole(comm, o.plot, pb::levels_svg(run.levels));
  run.timer.lap("write");
}

/// Solves, marks and refines until there are levels enough. Yields the last one. Collective.
Solved solve_levels(Run& run, mesh::DistMesh mesh) {
  const auto& o = run.options;
  auto solved = solve_level(run, std::move(mesh), o.start);
  for (int level = 0; solved.mesh; ++level) {
    write_level(run, *solved.mesh);
    if (level == o.levels) break;
    if (o.tolerance > 0 && pb::meets(run.levels.back(), o.tolerance)) break;
    auto finer = tools::next_level(run.session, std::move(*solved.mesh), level, o.max_cells);
    run.timer.lap("refine");
    if (!finer) break;
    solved = solve_level(run, std::move(*finer), "potential");
  }
  return solved;
}

/// The mesh, and the case with the patches that its names stand for. Collective.
std::pair<mesh::DistMesh, pb::Case> read_inputs(cli::Session& session, const Options& o, const pb::Case& stated) {
  const auto& comm = session.comm();
  session.step("reading " + o.mesh);
  const bool needs_surfaces = !stated.estimator.goals.empty() || stated.solver.order == 2 || o.levels > 0;
  auto mesh = assemble::assemble(
      comm, io::read_native(comm, o.mesh, {.build_surfaces = needs_surfaces, .remark = session.remarks()}));
  validate::require_valid(comm, mesh, o.mesh);
  auto input = pb::with_sheets(comm, pb::resolve_names(stated, mesh.info.patches, o.case_file), mesh, o.case_file);
  return {std::move(mesh), std::move(input)};
}

cli::ExitCode run(cli::Session& session, const Options& o) {
  const auto text = session.read_case(o.case_file);
  session.check_input(o.mesh);
  session.check_native_output(o.output, o.force);
  for (const auto& file : {o.surface, o.history, o.plot})
    if (!file.empty()) session.check_output(file, o.force);
  StepTimer timer;
  const auto stated = pb::read_case(text, o.case_file);
  if (o.tolerance > 0 && (o.levels == 0 || stated.estimator.goals.empty()))
    throw Error(fmt::format("--tolerance: expected {}, found none",
                            o.levels == 0 ? "--levels" : "a goal in [estimator] of the case, which has an error bar"));
  if (const auto word = pb::find_stray_word(o.petsc); !word.empty())
    throw Error(fmt::format("--petsc: expected options, each with one value at most, found '{}'", word));
  const pb::PetscRuntime petsc(session.comm(), stated.solver.petsc + " " + o.petsc);
  auto [mesh, input] = read_inputs(session, o, stated);
  timer.lap("read");
  if (const auto line = balance::what_stands_in(balance::method_named(o.balance)); !line.empty()) session.note(line);

  Run run{session, o, petsc, std::move(input), std::move(timer), {}};
  auto solved = solve_levels(run, std::move(mesh));
  auto& report = solved.report;
  if (o.levels > 0) report["levels"] = pb::levels_json(run.levels);
  if (!solved.mesh) {
    session.write_report(report);
    return cli::ExitCode::failed;
  }
  report["seconds"] = pb::seconds_of(run.timer.steps(), &StepTime::wall);
  report["cpu_seconds"] = pb::seconds_of(run.timer.steps(), &StepTime::cpu);
  report["peak_rss_bytes"] = session.comm().max(static_cast<std::int64_t>(peak_resident_bytes()));
  for (const auto& line : solved.warnings) session.warn(line);
  for (const auto& line : solved.results) session.summary(line);
  if (o.levels > 0)
    for (const auto& line : pb::describe_levels(run.levels)) session.summary(line);
  if (o.tolerance > 0 && !pb::meets(run.levels.back(), o.tolerance))
    session.warn(fmt::format("the error bar of a goal is missing or over {:g} of its value after {}", o.tolerance,
                             counted(std::ssize(run.levels), "level", "levels")));
  session.write_report(report);
  session.summary(fmt::format("{} cells, {} Newton steps, {} CG iterations, {:.2f} s -> {}", run.levels.back().cells,
                              solved.newton_iterations, solved.linear_iterations,
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
