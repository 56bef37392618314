// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/geometry/surface_set.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"

namespace pamr::dsmc {

/// The faces of the boundary, each of a patch with a surface cut into 16 along that surface: the wall but for a
/// sixteenth of what its flat faces are off. Faces without a surface stay as they are. `unit`: meters of a unit of
/// the mesh, in which the surfaces are. Local.
std::vector<BoundaryFace> faces_on_surfaces(const std::vector<BoundaryFace>& faces,
                                            const std::vector<mesh::Patch>& patches,
                                            const geometry::SurfaceSet& surfaces, double unit);

}  // namespace pamr::dsmc
