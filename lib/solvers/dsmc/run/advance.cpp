// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/advance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "pamr/base/timer.hpp"
#include "pamr/io/native/native_file.hpp"
#include "solvers/dsmc/run/history.hpp"

namespace pamr::dsmc {

namespace {

Phase phase_of(const Computation& computation) {
  const auto& averaging = computation.averaging();
  const auto done = static_cast<std::int64_t>(computation.flow().steps_done);
  if (averaging.waits_for_steady_flow()) return {"waiting for a steady flow", done, -1};
  return {"computing", done, static_cast<std::int64_t>(averaging.expected_steps())};
}

/// Collective. The largest of the ranks' values over their mean.
double imbalance_of(const par::Comm& comm, double here) {
  double most = 0, sum = 0;
  for (const double one : comm.all_gather(here)) {
    most = std::max(most, one);
    sum += one;
  }
  return sum > 0 ? most * comm.size() / sum : 1;
}

/// Collective. `n_steps`: done by this computation; `particle_steps`: of them on this rank.
RankWork rank_work(const Computation& computation, std::int64_t n_steps, double particle_steps) {
  const auto& comm = computation.comm();
  const auto& here = computation.traffic();
  const auto per_step = [&](std::int64_t count) {
    return static_cast<double>(count) / static_cast<double>(std::max<std::int64_t>(1, n_steps));
  };
  return {imbalance_of(comm, computation.computed()),
          imbalance_of(comm, particle_steps),
          per_step(comm.sum(here.messages)),
          per_step(comm.sum(here.bytes)),
          per_step(comm.max(here.rounds)),
          per_step(comm.max(here.reductions))};
}

}  // namespace

double Advance::rate() const { return particle_steps / std::max(cpu_seconds, 1e-9); }

std::string mesh_of_checkpoint(const std::string& checkpoint, std::uint64_t step) {
  return fmt::format("{}-{}.hdf", checkpoint, step);
}

CheckpointFile::CheckpointFile(std::string name, const Computation& computation) : name_(std::move(name)) {
  if (const auto step = computation.restarted_mesh()) before_ = mesh_of_checkpoint(name_, *step);
}

void CheckpointFile::write(Computation& computation) {
  const auto& comm = computation.comm();
  auto snapshot = computation.snapshot();
  if (computation.the_case().adaptation.every == 0) {
    write_checkpoint(comm, name_, snapshot);
    return;
  }
  const auto mesh = mesh_of_checkpoint(name_, computation.mesh_step());
  if (mesh != written_) io::write_native(comm, mesh, computation.mesh());
  snapshot.header["mesh_step"] = computation.mesh_step();
  snapshot.header["mesh_file"] = std::filesystem::path(mesh).filename().string();
  write_checkpoint(comm, name_, snapshot);
  std::error_code ignored;  // a mesh too many does no harm
  if (!before_.empty() && before_ != mesh && comm.is_first()) std::filesystem::remove(before_, ignored);
  written_ = before_ = mesh;
}

Advance advance(Computation& computation, const AdvanceOptions& options, const Observer& observer) {
  const auto& comm = computation.comm();
  const auto& state = computation.averaging().state();
  const double start = cpu_seconds();
  const auto steps_done = [&] { return computation.flow().steps_done; };
  CheckpointFile file(options.checkpoint, computation);
  const auto write = [&] { file.write(computation); };
  observer.begin_phase(phase_of(computation));
  double particle_steps = 0;
  const auto first_step = steps_done();
  const auto averages_since = [&] { return state.sampling ? std::optional(state.sampling_since) : std::nullopt; };
  auto since = averages_since();
  StepResult last{computation.is_complete(), false};
  while (!last.is_complete && !last.stop && !(options.steps && steps_done() >= *options.steps)) {
    last = computation.step(observer.wants_stop());
    particle_steps += static_cast<double>(computation.flow().particles.size());
    if (!last.stop && !options.checkpoint.empty() && options.every > 0 && steps_done() % options.every == 0) write();
    if (last.window_full) observer.window_full(computation);
    if (const auto now = averages_since(); now != since) {
      since = now;
      observer.report(state.steady_reason);
      observer.begin_phase(phase_of(computation));
    }
    observer.after_step(static_cast<std::int64_t>(steps_done()), particles_and_drift(state.history));
  }
  if (!options.checkpoint.empty()) write();
  Advance result{static_cast<double>(comm.sum(static_cast<std::int64_t>(particle_steps))), 0,
                 rank_work(computation, static_cast<std::int64_t>(steps_done() - first_step), particle_steps),
                 last.stop};
  for (const double one : comm.all_gather(cpu_seconds() - start)) result.cpu_seconds += one;
  return result;
}

}  // namespace pamr::dsmc
