// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "solvers/dsmc/flow/flow.hpp"
#include "solvers/dsmc/run/flow_case.hpp"
#include "solvers/dsmc/sampling/estimate.hpp"
#include "solvers/dsmc/sampling/loads.hpp"
#include "solvers/dsmc/sampling/steadiness.hpp"
#include "solvers/dsmc/state/run_state.hpp"

namespace pamr::dsmc {

/// Loads on the body and on each wall.
struct Results {
  struct OfPatch {
    std::string patch;
    Estimate drag, lift, moment, heat;
  };
  /// How a coefficient of the body has changed while it was averaged.
  struct Trend {
    std::string coefficient, name;  ///< C_D, "the drag"; of a net flux the patch
    Line line;                      ///< through the groups
  };
  OfPatch body;                ///< of the reference patches together
  std::vector<OfPatch> walls;  ///< of each patch that is a wall
  std::size_t n_blocks = 0;
  Grouping groups;            ///< of the blocks: what the errors of the loads come from
  std::vector<Trend> trends;  ///< of drag, heat and net fluxes of `openings_`, if there are ten groups; not in windows
};

/// Those that drift, in words, with bounds of 95 %: a flow that was not steady. Empty if none does. Local.
std::string drifts_of(const std::vector<Results::Trend>& trends);
/// Whether all coefficients and their errors are numbers. Local.
bool is_finite(const Results& results);

/// Decides when the averages of a flow begin and when they suffice, and keeps history, blocks and sums. If averages
/// began because the flow seemed steady, they are restarted when drag or heat (in ducts also the net flux) drifts.
///
/// A run is divided into intervals: of the transient, each a tenth of a passage, the time in which the free stream (for
/// a gas at rest: its fast molecules) passes the domain, or in which a flow through patches forgets itself; and of the
/// averages, the blocks of the schedule.
class Averaging {
 public:
  /// Collective.
  Averaging(const Case& the_case, const mesh::DistMesh& mesh, const Flow& flow);

  /// Switches the flow's sampling on if the case says that averages begin now. Call before each step. Collective.
  void before_step(Flow& flow);
  /// Adds the counts of a step to the interval, and ends the interval when it is full. Collective.
  void after_step(Flow& flow, const StepTotals& counts);
  /// Whether the steps that were done fill a window of the averages (never without windows).
  bool is_window_full(std::uint64_t steps_done) const;
  /// Averages and sums on walls begin anew, on the flow's domain as it is now. Local.
  void begin_window(Flow& flow);
  /// To be called when the gas was changed by something else than a step: the balance then starts from the contents
  /// before the next step.
  void forget_contents() { state_.contents = {}; }
  /// Ends averaging that has too few steps for a block, so that what there is counts, and compares the contents of the
  /// gas with what has passed the patches until now. Call it once, after the last step. Collective.
  void finish(Flow& flow);

  /// The run goes on from this state. Averages that have begun keep their blocks, so that all are of one length; throws
  /// `Error` if the case asks for blocks of another one. Local.
  void resume(RunState state);
  /// The run begins with a flow transferred from another mesh, at this step.
  void begin_transferred(std::uint64_t step);

  bool is_complete(std::uint64_t steps_done) const;
  /// Steps of a complete run as far as is known now.
  std::uint64_t expected_steps() const;
  /// True while nobody knows when averages begin.
  bool waits_for_steady_flow() const { return !state_.sampling && !schedule_.transient; }
  Results results() const;
  /// Rates of molecules, momentum and energy through a surface (patches first, then planes), with the errors of
  /// `flux_groups`. `species` below 0: all. Local.
  SurfaceFlux flux(std::size_t surface, int species, std::size_t n_species) const;
  Grouping flux_groups() const;
  std::int64_t block_steps() const { return state_.block_steps; }
  /// Steps of a passage: what happens in them depends on each other.
  std::int64_t passage_steps() const;
  const RunState& state() const { return state_; }
  const Scale& scale() const { return scale_; }

 private:
  std::uint64_t discarded() const;  ///< steps of a transferred flow that do not count
  std::uint64_t first_sampled_step() const;
  void begin_sampling(Flow& flow, Begun begun, const std::string& reason);
  void begin_anew_if_not_steady(Flow& flow);
  void end_interval(Flow& flow);
  void end_fluxes(Flow& flow, GasContents contents, HistoryRow& row);
  void assess_steadiness_of(Flow& flow);

  /// Coefficients of a part of the walls, a value for each block.
  struct CoefficientSeries {
    std::vector<double> drag, lift, moment, heat;
  };
  using LoadOf = std::function<Load(const std::vector<Load>&)>;  ///< from those of the patches
  CoefficientSeries series_of(const LoadOf& part) const;
  Grouping groups() const;
  std::vector<Results::Trend> trends() const;

  Schedule schedule_;
  Vec3 point_;  ///< m, about which moments are taken
  Scale scale_;
  std::vector<bool> body_;                                  ///< of each patch: belongs to the reference body
  std::vector<std::pair<std::size_t, std::string>> walls_;  ///< number and name of each patch that is a wall
  std::vector<std::pair<std::size_t, std::string>>
      openings_;  ///< the same of open ones if gas at rest comes through them
  std::int64_t interval_ = 1;
  RunState state_;
};

}  // namespace pamr::dsmc
