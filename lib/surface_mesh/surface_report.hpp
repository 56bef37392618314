// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "surface_mesh/decimate.hpp"
#include "surface_mesh/describe.hpp"
#include "surface_mesh/repair.hpp"

namespace pamr::surface_mesh {

/// Reports for people and for scripts.
nlohmann::json to_json(const Description& description);
nlohmann::json to_json(const Repaired& repaired);
nlohmann::json to_json(const SurfaceDistance& distance);
/// A few lines with all that there is to say; faults are left to `faults_of`.
std::vector<std::string> lines_of(const Description& description);

}  // namespace pamr::surface_mesh
