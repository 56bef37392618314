// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "solvers/poisson_boltzmann/analysis.hpp"

namespace pamr::poisson_boltzmann {

/// The report of pamr-pb (docs/tools/pamr-pb.md) but for its times. Local.
nlohmann::json report_of(const Domain& domain, const Case& problem, const Solution& solution, const Analysis& analysis);

/// Forces, charges and error in lines for the user. Local.
std::vector<std::string> describe_results(const Case& problem, const Analysis& analysis);

/// A line of the convergence table and its head.
std::string table_head();
std::string table_line(const NewtonStep& step);

}  // namespace pamr::poisson_boltzmann
