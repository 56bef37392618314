// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/plane_fit.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

/// Angle between a boundary face and a surface, degrees, from which on they meet in a sharp edge.
inline constexpr double sharp_edge_angle = 40;

/// Nodal field (length unit): how far a refinement has moved nodes off the faces of a patch without a surface, which
/// continues a surface smoothly. 0 elsewhere.
inline constexpr const char* off_facets_field = "off_facets";

/// Whether the boundary face a b c meets the surface in a sharp edge at its edge from a to b.
bool is_sharp_edge(geometry::Vec3 a, geometry::Vec3 b, geometry::Vec3 c, const geometry::Surface& surface);

/// A patch without a surface whose nodes others may take with them: it has some in common with a patch on a curved
/// surface, or with one on a plane that they are off (nodal field `off_surface`).
struct UndescribedPatch {
  int patch = 0;
  PlaneFit plane;
  /// Faces that continue a curved surface smoothly (at less than `sharp_edge_angle`); not counted on flat patches.
  std::int64_t n_smooth_faces = 0;
  int continues = -1;  ///< the last patch on such a surface, -1: none
};

/// Finds them, ascending by patch. The same on every rank and for any number of ranks.
/// Collective: nothing unless the mesh has both kinds of patches; then an exchange of shared nodes and one reduction,
/// and where the two kinds meet another exchange and 17 reductions. Cost: O(cells).
std::vector<UndescribedPatch> find_undescribed_patches(const par::Comm& comm, const DistMesh& mesh,
                                                       const Borders& borders);
/// The same where the borders are not at hand: finds them if there are both kinds of patches. Collective.
std::vector<UndescribedPatch> find_undescribed_patches(const par::Comm& comm, const DistMesh& mesh);

/// Gives the flat ones of these patches their planes as surfaces, named "plane of PATCH" and described like any other:
/// from now on the patch lies on it, at every level. Local.
MeshInfo with_planes(MeshInfo info, const std::vector<UndescribedPatch>& undescribed);

/// A line for each of these patches that new nodes of a neighbor will bend: how many faces, and what to write to keep
/// them; none for the others.
std::vector<std::string> warnings_of(const MeshInfo& info, const std::vector<UndescribedPatch>& undescribed);

}  // namespace pamr::mesh
