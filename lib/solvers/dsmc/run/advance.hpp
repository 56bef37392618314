// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "pamr/base/exact.hpp"
#include "solvers/dsmc/run/computation.hpp"

namespace pamr::dsmc {

struct AdvanceOptions {
  std::optional<std::uint64_t> steps;  ///< end after so many in all, transient included; none: as the case says
  std::string checkpoint;              ///< file, written at the end; empty: none
  Exact<std::uint64_t> every = 0;      ///< steps from checkpoint to checkpoint; 0: at the end only
};

/// The mesh beside a checkpoint of a run that adapts its mesh, which it did last after this step: NAME-STEP.hdf.
std::string mesh_of_checkpoint(const std::string& checkpoint, std::uint64_t step);

/// Writes the checkpoints of a computation. Of one that adapts its mesh the mesh is written too (`mesh_of_checkpoint`);
/// meshes of checkpoints that were replaced are removed.
class CheckpointFile {
 public:
  CheckpointFile(std::string name, const Computation& computation);
  /// Collective; throws `Error`. A file is replaced only when the new one is complete, and its mesh goes after that.
  void write(Computation& computation);

 private:
  std::string name_;
  std::string written_;  ///< the mesh of this run's last checkpoint
  std::string before_;   ///< that of the checkpoint that is there
};

/// What a computation is doing, for a progress display.
struct Phase {
  std::string what;
  std::int64_t done = 0;
  std::int64_t total = -1;  ///< steps; below 0: not known
};

/// Who looks on, and may ask for the end. Each function is called on every rank, and must not
/// communicate unless it says so.
struct Observer {
  std::function<bool()> wants_stop = [] { return false; };  ///< asked before each step
  /// When a window of the averages is full. May communicate, and must leave the computation as it is.
  std::function<void(Computation&)> window_full = [](auto&) {};
  std::function<void(const std::string&)> report = [](auto&) {};  ///< what happened, one line
  std::function<void(const Phase&)> begin_phase = [](auto&) {};   ///< a phase begins
  std::function<void(std::int64_t steps_done, const std::string& note)> after_step = [](auto, auto&) {};
};

/// What the ranks had to do with one another in a step, mean over the steps.
struct RankWork {
  double imbalance = 1;   ///< processor time of the slowest rank over the mean, communication apart
  double particles = 1;   ///< particle-steps of the rank with the most over the mean
  double messages = 0;    ///< of all ranks
  double bytes = 0;       ///< in them
  double exchanges = 0;   ///< between neighbors, of the rank with the most
  double reductions = 0;  ///< operations of all ranks together
};

/// How far a computation was advanced.
struct Advance {
  double particle_steps = 0;  ///< of all ranks
  double cpu_seconds = 0;     ///< of all ranks
  RankWork ranks;
  bool was_stopped = false;  ///< because the observer of some rank asked for it

  double rate() const;  ///< particle-steps per second of processor time
};

/// Advances the computation until the case or `options` is satisfied or an observer asks for the end; writes
/// checkpoints on the way and at the end. Collective. Throws `Error` when a checkpoint cannot be written.
Advance advance(Computation& computation, const AdvanceOptions& options, const Observer& observer);

}  // namespace pamr::dsmc
