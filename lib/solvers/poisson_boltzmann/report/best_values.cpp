// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/report/best_values.hpp"

#include <algorithm>
#include <cmath>

namespace pamr::poisson_boltzmann {

namespace {

/// The goal that estimates this quantity of this patch.
const GoalResult* goal_of(const Analysis& analysis, Goal::Kind kind, int axis, const std::string& body) {
  const auto found = std::find_if(analysis.goals.begin(), analysis.goals.end(), [&](const GoalResult& result) {
    const auto& goal = result.goal;
    return goal.kind == kind && goal.axis == axis && goal.body == body && result.value;
  });
  return found == analysis.goals.end() ? nullptr : &*found;
}

BestValue corrected(std::string quantity, double value, const char* from, const GoalResult* goal) {
  BestValue best{std::move(quantity), value, std::nullopt, "no goal", 0, false, false, false, from};
  if (goal != nullptr) {
    best.value += goal->best_correction();
    best.error = goal->error_bar;
    best.no_error = goal->no_error_bar;
    best.of_box = goal->of_box;
    best.is_goal = true;
    best.is_corrected = goal->is_corrected;
    best.is_coarse = goal->is_coarse;
  }
  return best;
}

/// The force through the mid-plane along this axis, with its error where it is a goal.
BestValue through_midplane(const Analysis& analysis, double force, std::string quantity) {
  const auto* goal = goal_of(analysis, Goal::Kind::midplane, 0, "");
  auto best = corrected(std::move(quantity), force, "midplane", goal);
  // The goal is the force away from the mirror.
  if (goal != nullptr) best.value = force + std::copysign(1.0, force * *goal->value) * goal->best_correction();
  return best;
}

}  // namespace

std::vector<BestValue> best_values(const Case& input, const Analysis& analysis, const PatchResult& patch) {
  std::vector<BestValue> result;
  if (patch.electrode == nullptr) return result;
  const auto& mirrors = patch.electrode->mirrors;
  if (patch.charge)
    result.push_back(
        corrected("charge", *patch.charge, "reaction", goal_of(analysis, Goal::Kind::charge, 0, patch.name)));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (mirrors.vanishes(axis)) continue;
    const auto quantity = std::string("force-") + "xyz"[axis];
    const auto* goal = goal_of(analysis, Goal::Kind::force, static_cast<int>(axis), patch.name);
    if (goal == nullptr && patch.midplane && (*patch.midplane)[axis] != 0)
      result.push_back(through_midplane(analysis, (*patch.midplane)[axis], quantity));
    else if (patch.volume)
      result.push_back(corrected(quantity, (*patch.volume)[axis], "volume", goal));
  }
  const bool is_body =
      std::any_of(input.bodies.begin(), input.bodies.end(), [&](const Body& body) { return body.name == patch.name; });
  const auto left = mirrors.complete_torque({1, 1, 1});
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (is_body && patch.torque && left[axis] != 0)
      result.push_back(corrected(std::string("torque-") + "xyz"[axis], (*patch.torque)[axis], "volume",
                                 goal_of(analysis, Goal::Kind::torque, static_cast<int>(axis), patch.name)));
  return result;
}

}  // namespace pamr::poisson_boltzmann
