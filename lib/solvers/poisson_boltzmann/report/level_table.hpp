// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "solvers/poisson_boltzmann/goals/analysis.hpp"

/// How values and their error bars change from level to level of one run.
namespace pamr::poisson_boltzmann {

/// One quantity on one level.
struct LevelValue {
  std::string of;               ///< patch or body; empty: of all
  std::string quantity;         ///< "charge", "force-x", "energy"
  double value = 0;             ///< dimensionless, corrected by its estimated error where it is a goal
  std::optional<double> error;  ///< error bar
  bool is_goal = false;
};

struct Level {
  std::int64_t cells = 0;
  std::int64_t unknowns = 0;
  std::vector<LevelValue> values;
};

/// The best values of all patches and bodies, then the goals that belong to none of them. Local.
Level level_of(const Domain& domain, const Case& input, const Analysis& analysis);

/// Whether the error bar of every goal is there and at most `tolerance` of its value; false without goals. Local.
bool meets(const Level& level, double tolerance);

/// The quantities that any level has a value of, in the order in which they are met first. Local.
std::vector<LevelValue> all_quantities(const std::vector<Level>& levels);

/// A table for each quantity: level, cells, value with error bar. `levels` is not empty. Local.
std::vector<std::string> describe_levels(const std::vector<Level>& levels);
/// level,cells,unknowns,of,quantity,value,error: a line for each level and quantity; no error where none is known.
/// Local.
std::string levels_csv(const std::vector<Level>& levels);
nlohmann::json levels_json(const std::vector<Level>& levels);

}  // namespace pamr::poisson_boltzmann
