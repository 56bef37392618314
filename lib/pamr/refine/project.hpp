// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/refine/movable.hpp"
#include "pamr/refine/number.hpp"

namespace pamr::refine {

/// The surfaces that the given patches are tied to, without repeats, in patch order.
std::vector<const geometry::Surface*> surfaces_of(const mesh::MeshInfo& info, const geometry::SurfaceSet& surfaces,
                                                  const std::array<int, max_node_patches>& patch);

/// Where the new boundary nodes belong: on the surface of their patch, on the common curve of two. Only edges that lie
/// in the boundary get such a node; flat surfaces move nothing. Local: every rank that holds a node computes the same
/// bits. Ascending in node. Source: the PAMR paper, section 2.1.4.
std::vector<Movable> project_new_nodes(const mesh::DistMesh& mesh, const Numbering& numbering,
                                       const geometry::SurfaceSet& surfaces);

/// The same for old nodes that an earlier refinement had to leave off their surface (nodal field `off_surface` > 0):
/// they are tried again. Collective where the mesh has that field: one neighbour exchange of their patches.
std::vector<Movable> project_ledger(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                                    const geometry::SurfaceSet& surfaces);

}  // namespace pamr::refine
