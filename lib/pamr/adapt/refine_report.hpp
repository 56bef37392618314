// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pamr/adapt/adapt.hpp"

namespace pamr::adapt {

/// What the tool itself measured beside the refinement; of this rank where not said otherwise.
struct Measured {
  /// The step that looks at the result for the report: reported apart, because it is no part of a refinement.
  static constexpr const char* check_step = "check";

  std::vector<StepTime> steps;         ///< of the whole run, in order, without gaps
  std::int64_t inverted_cells = 0;     ///< of the result, by exact arithmetic, all ranks
  std::int64_t cells_below_floor = 0;  ///< of the result: mean ratio under the shape floor, all ranks
  std::uint64_t fingerprint = 0;       ///< of the result
  std::size_t bytes_at_rest = 0;       ///< of the result
  std::int64_t bytes_read = 0;         ///< from files
  std::int64_t cells_here = 0;         ///< of the result, on this rank
  bool lists_ranks = false;            ///< the report also gives each rank's share of every step
};

/// Counts of a refinement, by the keys of docs/tools/pamr-refine.md. Local.
nlohmann::json to_json(const Report& report);
/// Counts of coarsening, by the keys of docs/coarsening.md. Local.
nlohmann::json to_json(const CoarseningReport& report);

/// Why flagged cells were not coarsened where none was, because they know no parent; empty otherwise. That is no error.
/// Local.
std::string nothing_coarsened_text(const CoarseningReport& report);
/// The shapes that a map of level 0 makes, by the keys of docs/tools/pamr-refine.md. Local.
nlohmann::json to_json(const curved::Level0Shapes& shapes);

/// The JSON report of docs/tools/pamr-refine.md, complete on every rank: `to_json(report)` and what was measured.
/// Collective.
nlohmann::json make_report(const par::Comm& comm, const adapt::Report& report, const Measured& measured);

/// Memory that this process shares with others (MPI's buffers between the processes of a machine) and has touched; 0
/// where the system does not tell.
std::int64_t shared_resident_bytes();

/// Bytes that this process has read from files and sockets so far; 0 where the system does not tell.
std::int64_t bytes_read_so_far();

}  // namespace pamr::adapt
