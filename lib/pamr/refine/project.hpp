// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/refine/movable.hpp"
#include "pamr/refine/number.hpp"

namespace pamr::refine {

/// What a node on these patches lies on.
struct SurfacesOfNode {
  std::vector<const geometry::Surface*> surface;  ///< without repeats, in patch order
  bool is_on_seam = false;  ///< two patches of one surface: their border is a curve of that surface
  bool all_tied = false;    ///< every one of the patches has a surface

  /// The place on them that a node at `point` belongs to. `converged` is false when there is none near by.
  geometry::Projected place(geometry::Vec3 point) const {
    if (is_on_seam) return {surface.front()->project_to_seam(point), true};
    return geometry::project_onto_all(surface, point);
  }
};
SurfacesOfNode surfaces_of_node(const mesh::MeshInfo& info, const geometry::SurfaceSet& surfaces,
                                const PatchList& patch);

/// Patches at a new node on the boundary.
PatchList patches_of(const BoundaryNode& boundary);

/// Where the new boundary nodes belong: on the surface of their patch, on the common curve of two. Only edges that lie
/// in the boundary get such a node; flat surfaces move nothing. Every rank that holds a node computes the same bits.
/// Ascending in node. Edges along sharp edges inside the surface of their patch (`Creases::crease_between`) get
/// their node there, held. Collective where a patch has such a surface: one exchange over the border edges, of the
/// third corners of the boundary faces; else local. Source: the PAMR paper, section 2.1.4.
std::vector<Movable> project_new_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                                       const Numbering& numbering, const geometry::SurfaceSet& surfaces);

/// The same for old nodes that an earlier refinement had to leave off their surface (nodal field `off_surface` > 0):
/// they are tried again, those as far from a sharp edge of their only surface as the field says on that edge.
/// Collective where the mesh has that field: one neighbor exchange of their patches.
std::vector<Movable> project_ledger(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                                    const geometry::SurfaceSet& surfaces);

}  // namespace pamr::refine
