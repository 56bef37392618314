// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/base/toml_table.hpp"
#include "solvers/poisson_boltzmann/problem/pb_case.hpp"

namespace pamr::poisson_boltzmann {

/// Reads the goals of [estimator]: `goal = "force-x"`, or `goals = ["force-x", "force-z"]`, of `goal_patch`. Throws
/// `Error` for names that are no goals, for both keys at once, and where `goal_patch` is missing. Local.
std::vector<Goal> read_goals(const TomlTable& table);

}  // namespace pamr::poisson_boltzmann
