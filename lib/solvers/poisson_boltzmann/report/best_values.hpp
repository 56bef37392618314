// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solvers/poisson_boltzmann/goals/analysis.hpp"

namespace pamr::poisson_boltzmann {

/// The most trustworthy value of one quantity of a patch or body, on the full body.
struct BestValue {
  std::string quantity;         ///< "charge", "force-x", "torque-z"
  double value = 0;             ///< corrected by the estimated error if `is_corrected`
  std::optional<double> error;  ///< error bar; nothing where `no_error` says why
  std::string no_error;
  double of_box = 0;          ///< part of `error`
  bool is_goal = false;       ///< a goal estimates its error
  bool is_corrected = false;  ///< by the estimated error of a goal, where that holds
  bool is_coarse = false;     ///< `GoalResult::is_coarse`
  std::string from;           ///< "volume", "midplane", "reaction": the form
};

/// The best values of one patch or body: its charge, the components of its force that are not zero by symmetry, and
/// those of its torque if the case lists it as a body. A component that is not a goal is taken from the mid-plane if
/// that gives one, otherwise from the volume form. Local.
std::vector<BestValue> best_values(const Case& input, const Analysis& analysis, const PatchResult& patch);

}  // namespace pamr::poisson_boltzmann
