// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>

#include "solvers/dsmc/run/run.hpp"

namespace pamr::dsmc {

/// The state of a run but for the sums on faces, with every bit of its numbers.
nlohmann::json to_json(const RunState& state);
/// The reverse; the sums on `n_faces` faces are 0. Throws `Error` when the text is not that of a state.
RunState run_state_from(const nlohmann::json& json, std::size_t n_faces);

}  // namespace pamr::dsmc
