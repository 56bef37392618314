// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

/// The plane of a patch, and how far its nodes lie from it, length unit.
struct PlaneFit {
  geometry::Vec3 point;
  geometry::Vec3 normal;  ///< unit; its first component that is not zero is positive
  double distance = 0;    ///< largest one of a node of the patch from the plane; infinite where one is not finite
  double size = 0;        ///< diagonal of the patch's bounding box
  bool is_flat = false;   ///< the distance is rounding: at most `flatness_tolerance`
};

/// Distance from a plane up to which a patch of that size, whose coordinates are at most so large, counts as flat:
/// 1e-10 of its size, or 8 units in the last place of its coordinates if that is more.
double flatness_tolerance(double size, double largest_coordinate);

/// Lays a plane through each patch with `is_wanted`: normal to an axis where that is exact to rounding or nearer to the
/// nodes, otherwise through an extreme node, the node farthest from it, and the node farthest from the line of these.
/// One entry for each patch of the mesh; those of the other patches, and of patches without faces, are not flat.
/// The same bits for every number of ranks, partition and numbering: only coordinates decide.
/// Collective: 14 reductions of a few numbers a patch, none if no patch is wanted. Cost: O(cells), with memory for the
/// nodes of the patches.
std::vector<PlaneFit> fit_planes(const par::Comm& comm, const DistMesh& mesh, const std::vector<bool>& is_wanted);

}  // namespace pamr::mesh
