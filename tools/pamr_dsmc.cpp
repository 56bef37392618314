// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/output_file.hpp"
#include "cli/run_tool.hpp"
#include "cli/text_file.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/validate/validate.hpp"
#include "solvers/dsmc/run/computation.hpp"
#include "solvers/dsmc/run/flow_case.hpp"
#include "solvers/dsmc/run/plan.hpp"
#include "solvers/dsmc/run/run.hpp"
#include "solvers/dsmc/run/wall_file.hpp"
#include "solvers/dsmc/sampling/cell_resolution.hpp"
#include "solvers/dsmc/sampling/probes.hpp"
#include "solvers/dsmc/state/checkpoint.hpp"
#include "solvers/dsmc/state/transfer_particles.hpp"

namespace {

using namespace pamr;
using namespace pamr::dsmc;

struct Options {
  std::string case_file, mesh, output, surface, lines, history, restart, carry, checkpoint;
  std::optional<std::uint64_t> steps;
  std::uint64_t every = 0;
  bool plan = false, force = false;
};

void declare(CLI::App& app, Options& o) {
  app.add_option("CASE", o.case_file, "case file (TOML)")->required();
  app.add_option("--mesh", o.mesh, "mesh to compute on")->required()->type_name("MESH");
  app.add_option("-o,--output", o.output, "mesh to write: the same with the averaged flow as cell fields");
  app.add_option("--steps", o.steps, "end after so many steps in all, transient included (default: as the case says)")
      ->type_name("N")
      ->check(CLI::PositiveNumber);
  auto* checkpoint =
      app.add_option("--checkpoint", o.checkpoint,
                     "file to go on from, written at the end, on SIGTERM, SIGINT and SIGUSR1, and as --every says")
          ->type_name("FILE");
  app.add_option("--every", o.every, "steps from checkpoint to checkpoint")
      ->type_name("N")
      ->check(CLI::PositiveNumber)
      ->needs(checkpoint);
  auto* restart = app.add_option("--restart", o.restart, "go on from this checkpoint, on the same mesh");
  restart->type_name("FILE");
  app.add_option("--carry", o.carry, "begin with the flow of this checkpoint, on the mesh that MESH was refined from")
      ->type_name("FILE")
      ->excludes(restart);
  app.add_option("--surface", o.surface, "averages on the walls, triangles in VTK's XML format")->type_name("FILE.vtu");
  app.add_option("--lines", o.lines, "averages at the case's stations on walls, lines and planes in the gas")
      ->type_name("FILE.csv");
  app.add_option("--history", o.history, "particles and loads over time")->type_name("FILE.csv");
  app.add_flag("--plan", o.plan, "print what is known beforehand, and end");
  app.add_flag("--force", o.force, cli::force_help);
}

volatile std::sig_atomic_t interrupted = 0;

/// From here on the signals that end jobs only ask for an end.
void watch_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = 1; };
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGTERM, SIGINT, SIGUSR1}) ::sigaction(signal, &action, nullptr);
}

void check_paths(cli::Session& session, const Options& o) {
  session.check_input(o.case_file);
  session.check_input(o.mesh);
  for (const auto& file : {o.restart, o.carry})
    if (!file.empty()) session.check_input(file);
  if (o.plan) return;
  if (o.output.empty()) throw Error("expected -o OUT or --plan, found neither");
  for (const auto& file : {o.output, o.surface, o.lines, o.history})
    if (!file.empty()) session.check_output(file, {o.case_file, o.mesh, o.restart, o.carry}, o.force);
  if (o.checkpoint.empty()) return;
  // A run goes on from the checkpoint that it replaces.
  session.check_output(o.checkpoint, {o.case_file, o.mesh, o.carry}, o.force || o.checkpoint == o.restart);
  watch_signals();
}

void warn_about(cli::Session& session, const Plan& plan) {
  if (plan.longest_flight > 2)
    session.warn(
        fmt::format("a fast molecule of the free stream passes {:.1f} cell sizes in one time step; the result "
                    "stays sound but coarse: use a shorter step",
                    plan.longest_flight));
  if (plan.particles_per_cell < 5)
    session.warn(fmt::format("{:.2g} particles a cell in the free stream: below 5 collisions are poorly resolved",
                             plan.particles_per_cell));
}

void write_text(const par::Comm& comm, const std::string& file, const std::string& text) {
  if (file.empty()) return;
  par::agree(comm, [&] {
    if (comm.is_first()) cli::write_whole(file, text);
  });
}

void add_fields(mesh::DistMesh& mesh, std::vector<CellQuantity> quantities) {
  for (auto& quantity : quantities) {
    mesh::CellField field{quantity.name, quantity.unit, quantity.n_components, mesh::StorageType::float64,
                          std::move(quantity.value)};
    if (auto* old = mesh.find_cell_field(field.name))
      *old = std::move(field);
    else
      mesh.cell_fields.push_back(std::move(field));
  }
}

nlohmann::json shown(const Estimate& e) { return {{"value", e.value}, {"stderr", e.error}}; }

nlohmann::json report_of(const Case& c, const Run& run, const Plan& plan, std::int64_t particles, double rate) {
  const auto results = run.results();
  const auto& flow = run.flow();
  nlohmann::json report{{"particles", particles},
                        {"steps", flow.steps_done},
                        {"particle_steps_per_second_per_core", rate},
                        {"lost_particles", flow.lost()},
                        {"C_D", shown(results.drag)},
                        {"C_L", shown(results.lift)},
                        {"C_m", shown(results.moment)},
                        {"C_H", shown(results.heat)},
                        {"lambda_inf", plan.mean_free_path},
                        {"blocks", results.n_blocks},
                        {"began_at_step", run.state.first_step},
                        {"averages_from_step", run.state.sampling_since},
                        {"steady", run.state.steady_reason},
                        {"abandoned_particles", run.state.abandoned},
                        {"clamped_relaxations", run.state.clamped}};
  const auto& r = c.reference;
  report["reference"] = {{"area", r.area},
                         {"length", r.length},
                         {"point", {r.point.x, r.point.y, r.point.z}},
                         {"multiplier", r.multiplier},
                         {"patches", r.patches},
                         {"dynamic_pressure", run.scale().dynamic_pressure()},
                         {"speed", run.scale().speed()}};
  for (const auto& s : c.gas.species)
    report["species"].push_back({{"name", s.name},
                                 {"mass", s.mass},
                                 {"diameter", s.diameter},
                                 {"omega", s.omega},
                                 {"t_ref", s.t_ref},
                                 {"alpha", s.alpha},
                                 {"rotational_degrees", s.rotational_degrees}});
  for (const auto& p : results.patches)
    report["patches"][p.patch] = {
        {"C_D", shown(p.drag)}, {"C_L", shown(p.lift)}, {"C_m", shown(p.moment)}, {"C_H", shown(p.heat)}};
  report["plan"] = to_json(plan);
  return report;
}

/// How far a call of the tool came.
struct Advance {
  double particle_steps = 0;  ///< of all ranks
  bool was_interrupted = false;
};

/// The particles, and by how much their number has changed in ten intervals: a flow that drifts is not steady.
std::string particles_and_drift(const std::vector<HistoryRow>& history) {
  if (history.empty()) return "";
  const double now = static_cast<double>(history.back().particles);
  auto text = fmt::format("{} particles", history.back().particles);
  if (history.size() <= 10) return text;
  const double then = static_cast<double>(history[history.size() - 11].particles);
  return text + fmt::format(", drift {:+.2f} %", 100 * (now - then) / std::max(1.0, then));
}

/// Steps until the case or --steps says that it is enough, or a signal asks for the end.
Advance advance(cli::Session& session, const Case& c, Computation& computation, const Options& options) {
  const auto& comm = session.comm();
  const auto run = [&]() -> const Run& { return *computation.run; };
  const auto show = [&] {
    const bool open = !run().state.sampling && !c.transient;
    const auto total = open ? -1 : static_cast<std::int64_t>(run().expected_steps());
    const auto before = static_cast<std::int64_t>(run().flow().steps_done);
    return std::unique_ptr<cli::Progress>(
        new cli::Progress(session.progress(open ? "waiting for a steady flow" : "computing", total, "steps", before)));
  };
  auto progress = show();
  double particle_steps = 0;
  bool was_sampling = run().state.sampling;
  const auto steps_done = [&] { return run().flow().steps_done; };
  const auto limit = [&] { return options.steps && steps_done() >= *options.steps; };
  bool complete = run().is_complete(), stop = false;
  while (!complete && !limit() && !stop) {
    complete = computation.step();
    particle_steps += static_cast<double>(run().flow().particles.size());
    if (!options.checkpoint.empty()) {
      stop = comm.any(interrupted != 0);
      if (!stop && options.every > 0 && steps_done() % options.every == 0)
        write_checkpoint(comm, options.checkpoint, computation.snapshot());
    }
    if (run().state.sampling && !was_sampling) {
      was_sampling = true;
      session.summary(run().state.steady_reason);
      progress.reset();  // takes its bar away first
      progress = show();
    }
    progress->update(static_cast<std::int64_t>(steps_done()), particles_and_drift(run().state.history));
  }
  return {static_cast<double>(comm.sum(static_cast<std::int64_t>(particle_steps))), stop};
}

std::string summary_of(const Run& run, std::int64_t particles, double rate, const std::string& output) {
  const auto results = run.results();
  std::string line = fmt::format("{} steps, {} particles, none lost, {:.3g} particle-steps per CPU second",
                                 run.flow().steps_done, particles, rate);
  if (results.n_blocks > 0 && !results.patches.empty())
    line += fmt::format("; C_D {:.4f} +- {:.4f}, C_L {:.4f} +- {:.4f}, C_m {:.4f} +- {:.4f}, C_H {:.4f} +- {:.4f}",
                        results.drag.value, results.drag.error, results.lift.value, results.lift.error,
                        results.moment.value, results.moment.error, results.heat.value, results.heat.error);
  return line + " -> " + output;
}

/// Fills the flow anew, from a checkpoint, or from that of a coarser mesh, and spreads it over the ranks.
void begin(cli::Session& session, const Options& options, Computation& computation) {
  const auto& comm = session.comm();
  auto& flow = computation.flow;
  auto& run = computation.run;
  if (!options.restart.empty()) {
    const auto snapshot = read_checkpoint(comm, options.restart, flow->setup().gas);
    restore(comm, snapshot, options.restart, computation.key(), *run, *flow);
  } else if (options.carry.empty()) {
    flow->fill(computation.mesh);
  } else {
    const auto carried = carry(comm, options.carry, computation.mesh, *flow);
    run->state.first_step = carried.step;
    run->state.carried = true;
    session.summary(
        fmt::format("carried {} particles from step {}: {} now inside walls removed, {} particles with the "
                    "new weight",
                    carried.old_particles, carried.step, carried.removed, carried.new_particles));
  }
  computation.rebalance();
}

void warn_about(cli::Session& session, const CellQuality& quality) {
  if (quality.few_in_dense_gas > 0.1)
    session.warn(
        fmt::format("{:.0f} % of the {:.0f} cells denser than the free stream have fewer than 5 particles: use "
                    "more particles or fewer cells",
                    100 * quality.few_in_dense_gas, quality.cells_of_dense_gas));
}

/// Everything that is asked for besides checkpoints; returns the quality of the cells.
CellQuality write_outputs(cli::Session& session, const Options& options, const Case& c, Computation& computation) {
  const auto& comm = session.comm();
  const auto& flow = *computation.flow;
  const auto& run = *computation.run;
  auto fields = flow_fields(flow.domain(), flow.setup().gas, flow.cells, flow.collisions, flow.setup().unit);
  const auto faces = wall_faces(comm, run);
  const auto quality = judge_cells(comm, fields, c.stream.front().density);
  if (!options.lines.empty()) {
    const auto lines =
        point_rows(comm, points_of(c.line, c.plane), computation.mesh, flow.setup().unit, flow.domain(), fields);
    write_text(comm, options.lines, probe_header + station_rows(c.station, faces) + lines);
  }
  add_fields(computation.mesh, std::move(fields));
  io::write_native(comm, options.output, computation.mesh);
  write_text(comm, options.surface, to_vtu(faces, flow.setup().unit));
  write_text(comm, options.history, run.history_csv());
  return quality;
}

cli::ExitCode run_case(cli::Session& session, const Options& options) {
  const auto& comm = session.comm();
  check_paths(session, options);
  const auto c = read_case(cli::read_text(comm, options.case_file), options.case_file);
  auto mesh = assemble::assemble(comm, io::read_native(comm, options.mesh, {.build_surfaces = false}));
  validate::require_valid(comm, mesh, options.mesh);
  const auto setup = make_setup(comm, c, mesh);
  const auto plan = make_plan(comm, c, setup, mesh);
  const auto tell = [&] {
    for (const auto& line : describe(c, setup, plan)) session.summary(line);
    warn_about(session, plan);
  };
  if (options.plan) {
    tell();
    session.write_report(to_json(plan));
    return cli::ExitCode::done;
  }

  Computation computation(comm, c, std::move(mesh));
  begin(session, options, computation);
  tell();
  const double cpu = cpu_seconds();
  const auto [particle_steps, was_interrupted] = advance(session, c, computation, options);
  if (!options.checkpoint.empty()) write_checkpoint(comm, options.checkpoint, computation.snapshot());
  if (was_interrupted) {
    session.summary(fmt::format("interrupted after step {} -> {}", computation.flow->steps_done, options.checkpoint));
    return cli::ExitCode::interrupted;
  }
  auto& run = *computation.run;
  run.finish();
  double cpu_all = 0;
  for (const double one : comm.all_gather(cpu_seconds() - cpu)) cpu_all += one;
  const double rate = particle_steps / std::max(cpu_all, 1e-9);

  const auto quality = write_outputs(session, options, c, computation);
  warn_about(session, quality);
  const auto particles = computation.flow->n_particles();
  auto report = report_of(c, run, plan, particles, rate);
  report["rebalanced"] = computation.n_moves();
  report["quality"] = to_json(quality);
  session.write_report(report);
  session.summary(summary_of(run, particles, rate, options.output));
  return cli::ExitCode::done;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return pamr::cli::run_tool(
      argc, argv,
      {"pamr-dsmc", "Computes the flow of a rarefied gas by direct simulation Monte Carlo.",
       "pamr-mesh --shape sphere-in-box -o sphere.hdf && pamr-dsmc cases/free-molecular-sphere/case.toml --mesh "
       "sphere.hdf -o flow.hdf"},
      [&](CLI::App& app) { declare(app, options); }, [&](cli::Session& session) { return run_case(session, options); });
}
