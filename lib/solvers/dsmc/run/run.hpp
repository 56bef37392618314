// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "solvers/dsmc/kernel/flow.hpp"
#include "solvers/dsmc/run/flow_case.hpp"
#include "solvers/dsmc/sampling/loads.hpp"
#include "solvers/dsmc/sampling/steady.hpp"

namespace pamr::dsmc {

/// One interval of a run: a row of its history.
struct HistoryRow {
  std::uint64_t step = 0;  ///< last step of the interval
  bool sampled = false;
  std::int64_t n_steps = 0;
  std::int64_t particles = 0;                                                        ///< at the end
  std::int64_t entered = 0, left = 0, wall_hits = 0, collisions = 0, crossings = 0;  ///< in the interval
  Coefficients body;                                                                 ///< of the reference patches
  double t_tr = 0, t_rot = 0;  ///< K, of all particles at the end, about their mean velocity
};

/// Sums over a boundary face since averaging began, and what its error follows from.
struct FaceTotals {
  SurfaceTally::Sums sums;
  double heat_squares = 0;      ///< of the energy of each block, in units of energy_unit squared
  double pressure_squares = 0;  ///< of the momentum along the normal
};

/// Where a run stands between two steps, besides the flow itself: everything that a checkpoint keeps.
struct RunState {
  bool sampling = false;
  std::uint64_t sampling_since = 0;  ///< step
  std::uint64_t first_step = 0;      ///< at which this computation began: that of a carried flow
  bool carried = false;              ///< began with a carried flow: one flow-through time is discarded
  std::string steady_reason;
  std::int64_t in_interval = 0;  ///< steps of the interval under way
  HistoryRow interval;           ///< its counts so far, of all ranks
  std::vector<HistoryRow> history;
  std::vector<std::vector<Load>> blocks;  ///< by block, then patch
  std::vector<FaceTotals> face;           ///< one for each boundary face of this rank
  std::int64_t abandoned = 0, clamped = 0;
};

/// What a run found.
struct Results {
  Estimate drag, lift, moment, heat;  ///< coefficients of the reference patches
  struct OfPatch {
    std::string patch;
    Estimate drag, lift, moment, heat;
  };
  std::vector<OfPatch> patches;  ///< walls
  std::size_t n_blocks = 0;
};

/// Drives a flow through its transient and its averages. Lengths in steps: `interval` of the transient, a tenth of the
/// time in which the free stream (a gas at rest: its fast molecules) passes the domain; `block` of the averages.
class Run {
 public:
  /// Collective.
  Run(const Case& the_case, const mesh::DistMesh& mesh, Flow& flow);

  /// One step, and what is due after it. Collective. True when the run is complete.
  bool step();

  bool is_complete() const;
  /// Steps of a complete run, as far as it is known now.
  std::uint64_t expected_steps() const;
  std::int64_t interval() const { return interval_; }
  Results results() const;
  const Scale& scale() const { return scale_; }
  const std::vector<bool>& body() const { return body_; }
  const Flow& flow() const { return *flow_; }
  const StepCounts& last_step() const { return last_step_; }  ///< of this rank
  std::string history_csv() const;
  /// Ends averaging begun with too few steps for a block, so that what there is counts. Collective.
  void finish();

  RunState state;

 private:
  std::uint64_t discarded() const;  ///< steps of a carried flow that do not count
  std::uint64_t first_sampled_step() const;
  void begin_sampling(const std::string& reason);
  void end_interval();
  Results::OfPatch of(const std::string& name, const std::function<Load(const std::vector<Load>&)>& part) const;

  const Case* case_;
  const mesh::DistMesh* mesh_;
  Flow* flow_;
  Scale scale_;
  std::vector<bool> body_;
  std::int64_t interval_ = 1, block_ = 1;
  StepCounts last_step_;
};

}  // namespace pamr::dsmc
