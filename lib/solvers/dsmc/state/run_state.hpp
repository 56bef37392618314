// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "solvers/dsmc/sampling/fluxes.hpp"
#include "solvers/dsmc/sampling/gas_balance.hpp"
#include "solvers/dsmc/sampling/loads.hpp"
#include "solvers/dsmc/sampling/wall_averages.hpp"

namespace pamr::dsmc {

/// One interval of a run: a row of its history.
struct HistoryRow {
  std::uint64_t step = 0;  ///< last step of the interval
  bool sampled = false;
  std::int64_t n_steps = 0;
  std::int64_t particles = 0;                                                        ///< at the end
  std::int64_t entered = 0, left = 0, wall_hits = 0, collisions = 0, crossings = 0;  ///< in the interval
  Coefficients body;                                                                 ///< of the reference patches
  double t_tr = 0, t_rot = 0;   ///< K, of all particles at the end, about their mean velocity
  std::vector<NetFlux> fluxes;  ///< of each surface; empty: not known, of an older version
  std::optional<double> t_vib;  ///< K, as the others; none: nothing vibrates
  /// `molecules_of_species`; empty also if not known, of an older version.
  std::vector<std::array<double, 2>> species{};
};

/// Why averages began.
enum class Begun : std::uint8_t {
  not_yet,
  by_case,        ///< the case says when
  steady,         ///< the flow was steady
  most_transient  ///< the flow was not steady for as long as the case allows
};
/// Its word in reports and checkpoints.
const char* word_for(Begun begun);

/// Where a run stands between two steps, apart from the flow itself: everything that a checkpoint keeps.
struct RunState {
  bool sampling = false;
  std::uint64_t sampling_since = 0;  ///< step
  std::int64_t block_steps = 1;      ///< of each block of the averages
  std::uint64_t first_step = 0;      ///< at which this run began: that of the flow it was transferred from
  bool transferred = false;          ///< began with a flow from a coarser mesh: one flow-through time is discarded
  std::string steady_reason;
  Begun begun = Begun::not_yet;  ///< why averages began the first time
  std::int64_t n_restarts = 0;   ///< of the averages, because they drifted
  std::int64_t in_interval = 0;  ///< steps of the current interval
  HistoryRow interval;           ///< its counts so far, of all ranks
  std::vector<HistoryRow> history;
  std::vector<std::vector<Load>> blocks;           ///< by block, then patch
  std::vector<std::vector<FluxRate>> flux_blocks;  ///< by block, then row of `FluxTally`; the last ones of `blocks`
  std::vector<FaceTotals> face;                    ///< one for each boundary face of this rank
  std::int64_t stuck = 0, clamped = 0;
  GasContents contents;  ///< when the current interval began
  GasBalance balance;    ///< of the intervals so far
};

/// The state of a run except the sums on faces, exact to the last bit. Local.
nlohmann::json to_json(const RunState& state);
/// What the state of a run must agree with.
struct RunExtent {
  std::uint64_t steps_done = 0;
  std::size_t n_patches = 0;
  std::size_t n_faces = 0;  ///< boundary faces of this rank
  std::size_t n_surfaces = 0, n_species = 0;
};
/// The reverse; the sums on faces are 0. Throws `Error` when the JSON is not the state of such a run: a value that is
/// missing, of another type, not finite or beyond what has been computed. Local.
RunState run_state_from(const nlohmann::json& json, const RunExtent& extent);

}  // namespace pamr::dsmc
