// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/surfaces_of_node.hpp"
#include "pamr/refine/movable.hpp"
#include "pamr/refine/number.hpp"

namespace pamr::refine {

using mesh::surfaces_of_node;
using mesh::SurfacesOfNode;

/// The patches of a mesh and the surfaces that their nodes are put onto. Only references.
struct Walls {
  const mesh::MeshInfo& info;  ///< patches that lie in a plane have it (`mesh::with_planes`)
  const geometry::SurfaceSet& surfaces;
};

/// Where new nodes belong that a map of level 0 places, and boundary nodes.
/// - New nodes whose place in level 0 is bent (`mesh::Level0Map`): where the map puts them, inside as on the boundary.
/// - Other new nodes on edges that lie in the boundary or in a face inside whose patch has a surface: on the surface of
///   their patch, on the common curve of two, in the corner of three. Flat
///   surfaces move nothing. Edges along sharp edges inside the surface of their patch (`Creases::crease_between`) get
///   their node there, held.
/// - Where a patch without a surface meets one with a surface in a sharp edge (`mesh::is_sharp_edge`): on the surface,
///   in the plane of the face of the other patch, which so keeps its shape. Where it continues the surface smoothly: on
///   the surface; `Movable::off_facets` says how far that is from the face.
/// - Old nodes that an earlier refinement had to leave off their surface (nodal field `off_surface` > 0): they are
///   tried again, those as far from a sharp edge of their only surface as the field says on that edge.
///
/// Every rank that holds a node computes the same bits. Order: old nodes, then new ones, ascending.
/// Collective: one neighbor exchange of the patches of old nodes if the mesh has the field, and one over the border
/// edges of the third corners of the boundary faces if a patch has a surface with sharp edges, or if patches with and
/// without a surface meet.
/// Source: the PAMR paper, section 2.1.4.
std::vector<Movable> project(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                             const Numbering& numbering, const Walls& walls);

}  // namespace pamr::refine
