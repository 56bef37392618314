// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cli/session.hpp"
#include "pamr/geometry/surface_set.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::convert {

/// Looks for patches without a surface that fit a sphere, cylinder, cone or torus (`meshing::recognize_shapes`), but
/// for those of the names in `described`, and says what to write for them. With `binds` returns the surfaces of those
/// that are certain, named as their patches. `report` gets `shapes`. Throws `Error` on every rank. Collective.
geometry::SurfaceSet find_known_shapes(cli::Session& session, const mesh::DistMesh& mesh,
                                       const std::vector<std::string>& described, bool binds, nlohmann::json& report);

}  // namespace pamr::convert
