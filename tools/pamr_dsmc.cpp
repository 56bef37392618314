// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/output_file.hpp"
#include "cli/run_tool.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/validate/validate.hpp"
#include "solvers/dsmc/run/advance.hpp"
#include "solvers/dsmc/run/flow_output.hpp"
#include "solvers/dsmc/run/flow_report.hpp"
#include "solvers/dsmc/run/flux_report.hpp"
#include "solvers/dsmc/run/make_setup.hpp"
#include "solvers/dsmc/run/plan.hpp"
#include "solvers/dsmc/run/require_feasible.hpp"
#include "solvers/dsmc/run/resolution_check.hpp"
#include "solvers/dsmc/run/stop_signals.hpp"

namespace {

using namespace pamr;

struct Options {
  std::string case_file, mesh, restart, carry, series;
  dsmc::OutputFiles out;
  dsmc::AdvanceOptions advance;
  bool plan = false, force = false, keep_cells = false, check_resolution = false, check_cells = false;
};

void declare(cli::CommandLine& line, Options& o) {
  line.option("CASE", o.case_file, "case file (TOML)").required();
  line.option("--mesh", o.mesh, "mesh to compute on").required().type_name("MESH");
  line.option("-o,--output", o.out.mesh, "mesh to write: the same with the averaged flow as cell fields");
  auto steps = line.option("--steps", o.advance.steps,
                           "end after N steps in total, transient included (default: as the case says)");
  steps.type_name("N").positive();
  line.flag("--plan", o.plan, "print what is known before the first step, and exit");
  line.flag("--keep-cells", o.keep_cells,
            "leave every cell on its rank for the whole run; without it cells move when that saves time");
  auto check = line.flag("--check-resolution", o.check_resolution,
                         "afterwards a second run with a quarter of the particles, for the error of the coefficients "
                         "that too few particles make");
  check.excludes(steps);
  line.flag("--check-cells", o.check_cells,
            "then another one with the cells at the walls split, for the error that coarse cells there make")
      .needs(check);
  line.flag("--force", o.force, cli::force_help);
  line.group("Checkpoints",
             "pamr-dsmc case.toml --mesh level0.hdf -o flow.hdf --checkpoint run.hdf --every 1000\n"
             "pamr-dsmc case.toml --mesh level1.hdf -o flow1.hdf --carry run.hdf");
  auto checkpoint = line.option("--checkpoint", o.advance.checkpoint,
                                "file to restart from, written at the end, on SIGTERM, SIGINT, SIGHUP and SIGUSR1, "
                                "and as --every says");
  checkpoint.type_name("FILE");
  line.option("--every", o.advance.every, "steps between checkpoints").type_name("N").positive().needs(checkpoint);
  auto restart = line.option("--restart", o.restart, "continue this checkpoint's run: the same case on the same mesh");
  restart.type_name("FILE");
  line.option("--carry", o.carry, "start with the flow of this checkpoint, on the mesh that MESH was refined from")
      .type_name("FILE")
      .excludes(restart);
  line.group("Other outputs", "pamr-dsmc case.toml --mesh level0.hdf -o flow.hdf --surface wall.vtu --lines lines.csv");
  line.option("--surface", o.out.surface, "averages on the walls: triangles in VTK's XML format").file_ending(".vtu");
  line.option("--lines", o.out.lines, "averages at the case's stations on walls, lines and planes in the gas")
      .file_ending(".csv");
  line.option("--history", o.out.history, "particles and loads over time").file_ending(".csv");
  line.option("--series", o.series,
              "the flow of each window of the averages ([run] window), with the mesh as it was then: NAME-STEP.hdf")
      .type_name("NAME");
}

/// Yields the text of the case file.
std::string check_inputs(cli::Session& session, const Options& o) {
  if (!o.plan && o.out.mesh.empty()) throw Error("expected -o OUT or --plan, found neither");
  auto text = session.read_case(o.case_file);
  for (const auto& file : {o.mesh, o.restart, o.carry})
    if (!file.empty()) session.check_input(file);
  return text;
}

std::string window_file(const Options& o, std::uint64_t step) { return fmt::format("{}-{:07}.hdf", o.series, step); }

/// The files of the series that the run will write after `steps_done` steps.
void check_series(cli::Session& session, const Options& o, const dsmc::Case& c, std::uint64_t steps_done) {
  if (o.series.empty()) return;
  const auto& schedule = c.schedule;
  if (schedule.window == 0) throw Error("--series: expected window in [run], found none");
  session.check_series([&](std::uint64_t step) { return window_file(o, step); }, steps_done + 1, o.force);
  const auto begin = schedule.transient.value_or(0);
  for (auto step = begin + schedule.window; step <= begin + schedule.sampling; step += schedule.window)
    session.remove_leftovers(window_file(o, static_cast<std::uint64_t>(step)));
}

/// A run may replace the checkpoint that it continues from, and the mesh of that checkpoint.
void check_checkpoint(cli::Session& session, const Options& o, const dsmc::Case& c, const dsmc::CheckpointHead& from) {
  const auto& checkpoint = o.advance.checkpoint;
  if (checkpoint.empty()) return;
  session.check_output(checkpoint, o.force, o.restart);
  if (c.adaptation.every == 0) return;
  const bool goes_on = !o.restart.empty() && cli::is_same_file(checkpoint, o.restart);
  session.check_series([&](std::uint64_t step) { return dsmc::mesh_of_checkpoint(checkpoint, step); }, 0,
                       o.force || goes_on, goes_on ? from.mesh_file : "");
}

/// `from`: the checkpoint to start from, if any.
void check_outputs(cli::Session& session, const Options& o, const dsmc::Case& c, const dsmc::CheckpointHead& from) {
  session.check_native_output(o.out.mesh, o.force);
  for (const auto& file : {o.out.surface, o.out.lines, o.out.history})
    if (!file.empty()) session.check_output(file, o.force);
  check_checkpoint(session, o, c, from);
  check_series(session, o, c, o.restart.empty() ? 0 : from.steps_done);
  if (!o.out.lines.empty() && c.station.empty() && c.line.empty() && c.plane.empty())
    session.warn("--lines: the case has no [[station]], [[line]] or [[plane]], and " + o.out.lines + " no rows");
}

/// The mesh that the run goes on with, and the weight that the case has for another mesh.
struct Place {
  std::string mesh;
  std::optional<double> fnum;
};
/// Of a restart of a run that adapts its mesh both are those of the checkpoint.
Place place_of(const Options& o, const dsmc::CheckpointHead& head, const dsmc::Case& c) {
  if (head.mesh_file.empty() || c.adaptation.every == 0) return {o.mesh, {}};
  return {head.mesh_file, head.fnum};
}

/// Of a run that adapts its mesh, MESH is not what a restart computes on, but it has to be what the run began with, or
/// the mesh of the checkpoint. Collective.
void require_begun_on(cli::Session& session, const Options& o, const dsmc::CheckpointHead& head, const Place& place) {
  if (o.restart.empty() || !head.begun_on || cli::is_same_file(place.mesh, o.mesh)) return;
  const auto& comm = session.comm();
  const auto given =
      assemble::assemble(comm, io::read_native(comm, o.mesh, {.build_surfaces = false, .remark = session.remarks()}));
  if (const auto found = mesh::fingerprint(comm, given); found != *head.begun_on)
    throw Error(
        fmt::format("--mesh {}: expected the mesh that the run of {} began with (fingerprint {:x}), or its mesh {}, "
                    "found another one (fingerprint {:x})",
                    o.mesh, o.restart, *head.begun_on, place.mesh, found));
}

void begin(cli::Session& session, const Options& o, dsmc::Computation& computation) {
  if (!o.restart.empty())
    computation.restart(o.restart);
  else if (!o.carry.empty())
    session.summary(summary_of(computation.transfer_from(o.carry)));
  else
    computation.fill();
  computation.rebalance();
  if (o.keep_cells) computation.keep_cells();
}

/// A restart of a run that has all its steps.
void note_if_finished(cli::Session& session, const Options& o, const dsmc::Computation& computation) {
  const auto done = computation.flow().steps_done;
  const bool has_all = computation.is_complete();
  if (o.restart.empty() || !(has_all || (o.advance.steps && done >= *o.advance.steps))) return;
  session.summary(fmt::format("nothing left to do: {} has {} steps, all that {}", o.restart, done,
                              has_all ? "the case asks for (sampling in [run])" : "--steps asks for"));
}

/// Prints the fluxes through patches and planes and the balance.
void show_fluxes(cli::Session& session, const dsmc::Computation& computation) {
  for (const auto& line : flux_lines(computation)) session.summary(line);
  session.summary(balance_line(computation.averaging().state().balance));
}

/// Shows what a computation does.
dsmc::Observer observer_of(cli::Session& session, std::unique_ptr<cli::Progress>& progress) {
  dsmc::Observer observer;
  observer.report = [&](const std::string& line) { session.summary(line); };
  observer.begin_phase = [&](const dsmc::Phase& phase) {
    progress.reset();  // takes the old bar off the terminal first
    progress.reset(new cli::Progress(session.progress(phase.what, phase.total, "steps", phase.done)));
  };
  observer.after_step = [&](std::int64_t done, const std::string& note) { progress->update(done, note); };
  return observer;
}

dsmc::Advance advance(cli::Session& session, const Options& o, dsmc::Computation& computation) {
  std::unique_ptr<cli::Progress> progress;
  auto observer = observer_of(session, progress);
  observer.wants_stop = dsmc::StopSignals::have_come;
  if (!o.series.empty())
    observer.window_full = [&](dsmc::Computation& now) {
      dsmc::write_window(now, window_file(o, now.flow().steps_done));
    };
  return dsmc::advance(computation, o.advance, observer);
}

/// The errors that too few particles and coarse cells make: computed if asked for, else what they depend on.
void check_resolution(cli::Session& session, const Options& o, const dsmc::Computation& computation,
                      dsmc::Outcome& outcome) {
  if (!o.check_resolution) {
    const double apart = outcome.resolution.wall_separation;
    if (computation.the_case().collisions.enabled && apart > 0)
      session.summary(
          fmt::format("partners that collide at the walls are {:.2g} mean free paths apart, in cells of {:.2g} (by "
                      "heat): +- are of chance only, --check-resolution adds what too few particles do, with "
                      "--check-cells what coarse cells do",
                      apart, outcome.resolution.wall_cell_size));
    return;
  }
  {
    std::unique_ptr<cli::Progress> progress;
    auto observer = observer_of(session, progress);
    observer.wants_stop = dsmc::StopSignals::have_come;
    outcome.check = dsmc::check_resolution(computation, outcome.resolution, o.check_cells, observer);
  }
  if (!outcome.check) return session.summary("interrupted in --check-resolution: the run itself is complete");
  for (const auto& line : describe(*outcome.check)) session.summary(line);
}

cli::ExitCode run_case(cli::Session& session, const Options& o) {
  const auto& comm = session.comm();
  const auto case_text = check_inputs(session, o);
  std::optional<dsmc::StopSignals> signals;
  if (!o.plan && !o.advance.checkpoint.empty()) signals.emplace();
  const auto c = dsmc::read_case(case_text, o.case_file);
  if (o.check_resolution) dsmc::require_checkable(c, o.check_cells);
  std::optional<dsmc::CheckpointHead> from;
  if (const auto& file = o.restart.empty() ? o.carry : o.restart; !file.empty()) from = dsmc::head_of(comm, file);
  if (from && !from->mesh_file.empty()) session.keep(from->mesh_file);
  if (!o.plan) check_outputs(session, o, c, from.value_or(dsmc::CheckpointHead{}));
  const auto place = place_of(o, o.restart.empty() ? dsmc::CheckpointHead{} : *from, c);
  const bool adapts = c.adaptation.every > 0;
  if (adapts) require_begun_on(session, o, from.value_or(dsmc::CheckpointHead{}), place);
  session.step("reading " + place.mesh);
  auto mesh = assemble::assemble(
      comm,
      io::read_native(comm, place.mesh, {.build_surfaces = adapts || o.check_resolution, .remark = session.remarks()}));
  validate::require_valid(comm, mesh, place.mesh);
  session.step(fmt::format("setting up {} cells", mesh.info.n_global_cells));
  auto setup = dsmc::make_setup(comm, c, mesh, place.fnum);
  dsmc::Outcome outcome{dsmc::make_plan(comm, c, setup, mesh, {from, !o.advance.checkpoint.empty()}), {}, {}, 0};
  try {
    dsmc::require_feasible(comm, c, setup, mesh, outcome.plan);
  } catch (const Error& error) {  // reaches every rank
    if (!o.plan) throw;
    session.warn(std::string("no run of this is possible here: ") + error.what());
  }
  std::optional<dsmc::Computation> computation;
  const auto lines = describe(c, setup, outcome.plan);
  if (!o.plan) {
    computation.emplace(comm, c, std::move(setup), std::move(mesh));
    if (o.check_cells) dsmc::require_walls(*computation);
    begin(session, o, *computation);
  }
  for (const auto& line : lines) session.summary(line);
  if (computation) note_if_finished(session, o, *computation);
  for (const auto& warning : warnings_of(outcome.plan)) session.warn(warning);
  if (o.plan) {
    session.write_report(to_json(outcome.plan));
    return cli::ExitCode::done;
  }
  outcome.advance = advance(session, o, *computation);
  if (outcome.advance.was_stopped) {
    session.summary(
        fmt::format("interrupted after step {} -> {}", computation->flow().steps_done, o.advance.checkpoint));
    return cli::ExitCode::interrupted;
  }
  session.step("writing " + o.out.mesh);
  computation->finish();
  outcome.resolution = write_output(*computation, o.out, [&](const std::string& file, const std::string& text) {
    cli::write_whole(comm, file, text);
    if (file != o.out.lines || !comm.is_first()) return;
    for (const auto& warning : warnings_of_lines(c, text)) session.warn(warning);
  });
  outcome.n_particles = computation->flow().n_particles();
  for (const auto& warning : warnings_of(outcome.resolution, c.collisions.enabled ? &c.gas : nullptr))
    session.warn(warning);
  for (const auto& warning : warnings_of(computation->averaging())) session.warn(warning);
  for (const auto& warning : driven_warnings(*computation)) session.warn(warning);
  check_resolution(session, o, *computation, outcome);
  session.write_report(report_of(*computation, outcome));
  show_fluxes(session, *computation);
  session.summary(fmt::format("{} -> {}", summary_of(*computation, outcome), o.out.mesh));
  if (dsmc::is_finite(computation->averaging().results()))
    return o.check_resolution && !outcome.check ? cli::ExitCode::interrupted : cli::ExitCode::done;
  session.warn("expected coefficients that are numbers, found one that is not finite");
  return cli::ExitCode::failed;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return pamr::cli::run_tool(
      argc, argv,
      {"pamr-dsmc", "Computes the flow of a rarefied gas by direct simulation Monte Carlo.",
       "pamr-mesh --shape sphere-in-box -o sphere.hdf && pamr-dsmc cases/free-molecular-sphere/case.toml --mesh "
       "sphere.hdf -o flow.hdf",
       dsmc::files_in_checkpoint},
      [&](cli::CommandLine& line) { declare(line, options); },
      [&](cli::Session& session) { return run_case(session, options); });
}
