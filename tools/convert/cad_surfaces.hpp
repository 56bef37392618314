// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cli/session.hpp"
#include "pamr/geometry/surface_set.hpp"
#include "pamr/mesh/dist_mesh.hpp"

/// Steps of pamr-convert.
namespace pamr::convert {

struct CadRequest {
  std::string file;                ///< STEP
  std::string unit;                ///< that the mesh is in
  double tolerance = -1;           ///< how far corners of faces may be off, length units; negative: the usual
  bool is_strict = false;          ///< patches that do not lie on the shape are errors, not remarks
  std::vector<std::string> named;  ///< patches that get a surface by name
};

/// Finds the faces of a CAD shape under the patches of a mesh, says what lies on none, and returns the surfaces.
/// `report` gets `cad`. Throws `Error` on every rank. Collective.
geometry::SurfaceSet find_cad_surfaces(cli::Session& session, const CadRequest& request, mesh::DistMesh& mesh,
                                       nlohmann::json& report);

}  // namespace pamr::convert
