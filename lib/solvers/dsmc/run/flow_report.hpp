// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "solvers/dsmc/run/advance.hpp"
#include "solvers/dsmc/run/computation.hpp"
#include "solvers/dsmc/run/plan.hpp"
#include "solvers/dsmc/run/resolution_check.hpp"
#include "solvers/dsmc/sampling/cell_resolution.hpp"

namespace pamr::dsmc {

/// Everything that a report on a computation says beside the computation itself.
struct Outcome {
  Plan plan;
  Advance advance;
  CellResolution resolution;
  std::int64_t n_particles = 0;  ///< of all ranks
  std::optional<ResolutionCheck> check{};
};

/// The report under the keys of docs/tools/pamr-dsmc.md. Local; the same on every rank.
nlohmann::json report_of(const Computation& computation, const Outcome& outcome);
/// The same in one line: steps, particles, rate and, where there are walls and blocks, their loads with bounds of 95 %.
/// Local.
std::string summary_of(const Computation& computation, const Outcome& outcome);
/// Warnings about the balance and about the errors of the averages. Local.
std::vector<std::string> warnings_of(const Averaging& averaging);
/// What became of the particles of the old mesh, in one line. Local.
std::string summary_of(const Transferred& transferred);

}  // namespace pamr::dsmc
