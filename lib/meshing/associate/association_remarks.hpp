// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "meshing/associate/associate_surfaces.hpp"
#include "pamr/geometry/surface_set.hpp"

namespace pamr::meshing {

/// Remarks on patches that were given surfaces, a sentence each: edges of the mesh across sharp ones, nodes that are
/// off, data that files of triangles have beside a surface, and where such surfaces cut through themselves (about half a
/// second for 100,000 triangles: one rank is enough). The same on every rank. Local.
std::vector<std::string> remarks_on(const std::vector<Association>& associations, const geometry::SurfaceSet& surfaces);

}  // namespace pamr::meshing
