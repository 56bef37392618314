// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pamr/base/timer.hpp"
#include "solvers/poisson_boltzmann/goals/analysis.hpp"

namespace pamr::poisson_boltzmann {

/// The report of pamr-pb (docs/tools/pamr-pb.md) but for its times. Local.
nlohmann::json report_of(const Domain& domain, const Case& input, const Solution& solution, const Analysis& analysis);
/// The report of a solve that has not converged. Local.
nlohmann::json failure_report(const Solution& solution);
/// Seconds of each step, `&StepTime::wall` or `&StepTime::cpu`, and their sum as "total". Local.
nlohmann::json seconds_of(std::span<const StepTime> steps, double StepTime::*seconds);

/// Forces, charges and error in lines for the user. Local.
std::vector<std::string> describe_results(const Case& input, const Analysis& analysis);
/// A line for each patch whose layer of counterions the mesh does not resolve: what that costs and what mends it.
/// Local.
std::vector<std::string> describe_layers(const Case& input, const Analysis& analysis);
/// How far a solve came that has not converged, in one line. Local.
std::string describe_failure(const Solution& solution);

/// "0.0410 +- 0.0002", "10.8027312 +- 1.7e-06": as many digits as the error bar is worth, six without one.
std::string with_error(double value, const std::optional<double>& error);

/// A line of the convergence table and its head.
std::string table_head();
std::string table_line(const NewtonStep& step);

}  // namespace pamr::poisson_boltzmann
