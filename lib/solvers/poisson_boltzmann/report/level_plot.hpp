// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "solvers/poisson_boltzmann/report/level_table.hpp"

namespace pamr::poisson_boltzmann {

/// The levels of a run as an SVG picture: a panel for each quantity, in dimensionless units, its values with their
/// error bars over the number of cells, on a logarithmic axis. Points without an error bar are open. `levels` is not
/// empty. Local.
std::string levels_svg(const std::vector<Level>& levels);

}  // namespace pamr::poisson_boltzmann
