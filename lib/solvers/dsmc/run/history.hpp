// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/state/run_state.hpp"

namespace pamr::dsmc {

/// The history of a run as CSV, one row per interval; `dt`: time step, s; `surfaces`: names of those with fluxes, in
/// their order. With several `species` each has its molecules through each surface, too. Local.
std::string to_csv(const std::vector<HistoryRow>& history, double dt, const std::vector<std::string>& surfaces,
                   const std::vector<Species>& species);

/// How many particles there are, and by how much their number has changed in ten intervals: a flow that drifts is not
/// steady. Empty without history. Local.
std::string particles_and_drift(const std::vector<HistoryRow>& history);

}  // namespace pamr::dsmc
