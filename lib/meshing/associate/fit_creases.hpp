// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::meshing {

/// How a patch of the mesh follows the sharp edges inside its surface.
struct CreaseFit {
  std::int64_t n_along = 0;   ///< mesh edges that run along them
  std::int64_t n_across = 0;  ///< mesh edges between triangles of two pieces, but not along the sharp edge between them
  double worst_across = 0;    ///< largest distance of an end of these from the sharp edges
};

/// Looks at the edges between two faces of the patch. `off` (a local node each) gets at the ends of edges along sharp
/// ones their distances from these, where that is the larger value: such nodes belong there. Collective: two sparse
/// exchanges of the patch's edges; the same result on every rank.
CreaseFit fit_creases(const par::Comm& comm, const mesh::DistMesh& mesh, int patch, const geometry::Surface& surface,
                      std::vector<double>& off);

}  // namespace pamr::meshing
