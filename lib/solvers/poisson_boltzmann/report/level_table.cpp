// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/report/level_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pamr/base/csv_field.hpp"
#include "solvers/poisson_boltzmann/report/best_values.hpp"
#include "solvers/poisson_boltzmann/report/pb_report.hpp"

namespace pamr::poisson_boltzmann {

namespace {

const LevelValue* find_value(const std::vector<LevelValue>& values, const LevelValue& like) {
  const auto found = std::find_if(values.begin(), values.end(), [&](const LevelValue& value) {
    return value.of == like.of && value.quantity == like.quantity;
  });
  return found == values.end() ? nullptr : &*found;
}

}  // namespace

std::vector<LevelValue> all_quantities(const std::vector<Level>& levels) {
  std::vector<LevelValue> all;
  for (const auto& level : levels)
    for (const auto& value : level.values)
      if (find_value(all, value) == nullptr) all.push_back(value);
  return all;
}

Level level_of(const Domain& domain, const Case& input, const Analysis& analysis) {
  const auto& info = domain.mesh->info;
  Level level{info.n_global_cells, domain.n_global_nodes(), {}};
  for (const auto& patch : analysis.patches)
    for (const auto& best : best_values(input, analysis, patch))
      level.values.push_back({patch.name, best.quantity, best.value, best.error, best.is_goal});
  for (const auto& result : analysis.goals)
    if (result.goal.body.empty() && result.goal.kind == Goal::Kind::energy && result.value)
      level.values.push_back({"", result.goal.name, *result.value + result.best_correction(), result.error_bar, true});
  return level;
}

bool meets(const Level& level, double tolerance) {
  bool has_goal = false;
  for (const auto& [of, quantity, value, error, is_goal] : level.values) {
    if (!is_goal) continue;
    has_goal = true;
    if (!error || !(*error <= tolerance * std::abs(value))) return false;
  }
  return has_goal;
}

std::vector<std::string> describe_levels(const std::vector<Level>& levels) {
  std::vector<std::string> lines;
  for (const auto& quantity : all_quantities(levels)) {
    lines.push_back(quantity.of.empty() ? quantity.quantity : quantity.of + " " + quantity.quantity);
    for (std::size_t k = 0; k < levels.size(); ++k) {
      const auto* value = find_value(levels[k].values, quantity);
      lines.push_back(fmt::format("  level {:>2}  {:>11} cells  {}", k, levels[k].cells,
                                  value == nullptr ? "not given" : with_error(value->value, value->error)));
    }
  }
  return lines;
}

std::string levels_csv(const std::vector<Level>& levels) {
  std::string text = "level,cells,unknowns,of,quantity,value,error\n";
  for (std::size_t k = 0; k < levels.size(); ++k)
    for (const auto& value : levels[k].values)
      text += fmt::format("{},{},{},{},{},{},{}\n", k, levels[k].cells, levels[k].unknowns, csv_field(value.of),
                          value.quantity, value.value, value.error ? fmt::format("{}", *value.error) : "");
  return text;
}

nlohmann::json levels_json(const std::vector<Level>& levels) {
  auto json = nlohmann::json::array();
  for (const auto& level : levels) {
    auto values = nlohmann::json::array();
    for (const auto& value : level.values)
      values.push_back({{"of", value.of},
                        {"quantity", value.quantity},
                        {"value", value.value},
                        {"error", value.error ? nlohmann::json(*value.error) : nlohmann::json(nullptr)}});
    json.push_back({{"cells", level.cells}, {"unknowns", level.unknowns}, {"quantities", std::move(values)}});
  }
  return json;
}

}  // namespace pamr::poisson_boltzmann
