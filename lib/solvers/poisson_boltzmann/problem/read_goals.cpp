// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/read_goals.hpp"

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "pamr/base/error.hpp"

namespace pamr::poisson_boltzmann {

namespace {

constexpr std::array<std::pair<Goal::Kind, const char*>, 5> goal_kinds{{{Goal::Kind::midplane, "midplane"},
                                                                        {Goal::Kind::force, "force"},
                                                                        {Goal::Kind::torque, "torque"},
                                                                        {Goal::Kind::charge, "charge"},
                                                                        {Goal::Kind::energy, "energy"}}};

/// "force-x", "charge"; `volume-x` is an older name of `force-x`. Nothing if it is no goal.
std::optional<Goal> goal_named(const std::string& name) {
  const auto dash = name.find('-');
  auto word = name.substr(0, dash);
  if (word == "volume") word = "force";
  Goal goal;
  goal.name = dash == std::string::npos ? word : word + name.substr(dash);
  const auto axis = dash == std::string::npos ? std::string() : name.substr(dash + 1);
  for (const auto& [kind, known] : goal_kinds) {
    if (word != known) continue;
    const bool has_axis = kind == Goal::Kind::force || kind == Goal::Kind::torque;
    if (has_axis != (dash != std::string::npos) || (has_axis && axis != "x" && axis != "y" && axis != "z"))
      return std::nullopt;
    goal.kind = kind;
    if (has_axis) goal.axis = axis[0] - 'x';
    return goal;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Goal> read_goals(const TomlTable& table) {
  std::vector<std::string> names;
  if (table.has("goals")) names = table.texts("goals");
  const auto one = table.find_text("goal");
  if (one && !names.empty())
    throw Error(table.at("goal") + ": expected either goal or goals in [estimator], found both");
  const std::string key = one ? "goal" : "goals";
  if (one && *one != "none") names.push_back(*one);
  const auto body = table.text_or("goal_patch", "");
  std::vector<Goal> goals;
  for (const auto& name : names) {
    auto goal = goal_named(name);
    if (!goal)
      table.refuse(key,
                   R"("none", "midplane", "force-x", "force-y", "force-z", "torque-x", "torque-y", "torque-z", )"
                   R"("charge" or "energy")",
                   "\"" + name + "\"");
    if (goal->kind != Goal::Kind::midplane && goal->kind != Goal::Kind::energy) {
      if (body.empty())
        table.refuse(key, "goal_patch = \"PATCH OR BODY\" in [estimator] for goal \"" + name + "\"", "none");
      goal->body = body;
    }
    for (const auto& other : goals)
      if (other.name == goal->name) table.refuse(key, "different goals", "\"" + goal->name + "\" twice");
    goals.push_back(std::move(*goal));
  }
  return goals;
}

}  // namespace pamr::poisson_boltzmann
