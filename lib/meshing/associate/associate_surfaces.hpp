// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "meshing/associate/fit_creases.hpp"
#include "pamr/geometry/surface_set.hpp"
#include "pamr/geometry/triangulated/named_parts.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::meshing {

/// How far the nodes of a patch lie from the surface that it was associated with.
struct Association {
  std::string patch, surface;
  double worst_distance = 0;
  double worst_excess = -1;          ///< largest distance over the tolerance
  std::int64_t n_off = 0;            ///< nodes off it, counted on every rank that holds them
  std::optional<CreaseFit> creases;  ///< where the surface has sharp edges inside
};

/// Surfaces to associate patches with.
struct AssociationRequest {
  geometry::SurfaceSet described;  ///< that a file of surfaces or a case describes
  geometry::SurfaceSet made;       ///< more surfaces
  std::vector<std::string> pairs;  ///< PATCH=SURFACE; a name may stand for several patches (`mesh::find_patches`)
  std::vector<std::pair<std::string, std::string>> files;  ///< a name likewise, and the file of a triangulated surface
  double feature_angle = -1;                               ///< of these files, degrees; negative: the default
  std::vector<std::vector<geometry::Vec3>> creases;        ///< of the only one of these files, polylines
  double tolerance = -1;                                   ///< length units; negative: the default
};

/// The named parts of a file of triangles that a patch is called after: their borders are those of the patches. Local.
geometry::PartChoice parts_with_patch(const std::vector<mesh::Patch>& patches);

/// Names of the patches that lie on these surfaces without being named: those of the surfaces and of parts of their
/// files.
std::vector<std::string> names_of_patches_on(const geometry::SurfaceSet& surfaces);

/// Gives patches their surfaces and says how far their nodes lie off them.
///
/// - A patch of the same name as a surface, or as a named part of one that is described, lies on it without being named
///   in `pairs`.
/// - Surfaces that the mesh has already are kept while a patch lies on one.
/// - Nodes that are off their surface by more than 1e-12 of the mesh's size get their distance in the nodal field
///   `off_surface`: the next refinement moves them there. So do nodes of edges along sharp edges inside a surface
///   (`fit_creases`) that are off these.
///
/// Collective. Throws `Error` on every rank for bad files, names that are not there, surfaces that no patch
/// uses, and when a node lies farther from its surface than the tolerance: 1e-6 of the mesh's size unless given, and
/// for triangulated surfaces 1.5 times the distance between the facets and the smooth surface there on top.
std::vector<Association> associate_surfaces(const par::Comm& comm, mesh::DistMesh& mesh,
                                            const AssociationRequest& request);

}  // namespace pamr::meshing
