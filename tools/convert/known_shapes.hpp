// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cli/session.hpp"
#include "pamr/geometry/surface_set.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::convert {

/// Patches that fit known shapes.
struct KnownShapes {
  geometry::SurfaceSet bound;  ///< surfaces of those to be put on their shape, named as the patches
  std::vector<std::string> remarks;
  std::vector<std::string> texts;  ///< for each remark the description of the surface
};

/// Looks for patches without a surface that fit a sphere, cylinder, cone or torus (`meshing::recognize_shapes`), but
/// for those of the names in `described`. With `binds` those that are certain are to be put on it. `report` gets
/// `shapes`. Throws `Error` on every rank. Collective.
KnownShapes find_known_shapes(const par::Comm& comm, const mesh::DistMesh& mesh,
                              const std::vector<std::string>& described, bool binds, nlohmann::json& report);

/// Says what was found, with the text to write: once nothing else can be wrong with the input. Local.
void tell_known_shapes(const cli::Session& session, const KnownShapes& shapes);

}  // namespace pamr::convert
