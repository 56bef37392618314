// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "solvers/dsmc/run/computation.hpp"

namespace pamr::dsmc {

/// Which averages a report can show.
struct KnownAverages {
  bool is_any = true;
  double student = 1;  ///< from a standard error to the bounds of 95 %; infinite: there is none
};

/// Names of the surfaces through which molecules are counted: the patches of the mesh, then the planes. Local.
std::vector<std::string> surfaces_of(const Computation& computation);

/// Fluxes through each patch and plane with bounds of 95 %, under the keys of docs/tools/pamr-dsmc-output.md. Local.
nlohmann::json fluxes_report(const Computation& computation);
/// The same, one line for each patch and plane; nothing without averages. Local.
std::vector<std::string> flux_lines(const Computation& computation);

/// Inlets and outlets that do not keep what the case asks for. Local.
std::vector<std::string> driven_warnings(const Computation& computation);

/// Whether what passed the patches is what the gas has lost. Local.
nlohmann::json balance_report(const GasBalance& balance);
/// In one line. Local.
std::string balance_line(const GasBalance& balance);

}  // namespace pamr::dsmc
