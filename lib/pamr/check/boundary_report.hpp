// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::check {

/// One boundary patch. A node on several patches counts for each of them.
struct PatchReport {
  std::string name;
  std::string surface;                 ///< empty: nothing to lie on, distances are 0
  std::int64_t faces = 0;              ///< boundary triangles
  double area = 0;                     ///< squared length unit
  double worst_distance = 0;           ///< largest distance of a node of the patch from its surface, length unit
  std::int64_t off_surface_nodes = 0;  ///< nodes farther from it than the tolerance
  double min_mean_ratio = 0;           ///< smallest of the cells with a face in the patch; 0 without faces
  /// Angle between a triangle and the surface at its middle, degrees from 0 to 90: mean by area, and largest. 0 without
  /// a surface.
  double mean_normal_deviation = 0, worst_normal_deviation = 0;
  /// Of a patch without a surface: whether it lies in a plane, the largest distance of a node from its plane
  /// (`mesh::fit_planes`), how many of its nodes refinements moved off its faces (nodal field `off_facets`), and how
  /// far at most.
  bool is_flat = false;
  double worst_plane_distance = 0;
  std::int64_t off_facets_nodes = 0;
  double worst_off_facets = 0;
};

/// Length of the diagonal of the box round all nodes; 0 for a mesh without nodes. Collective: one reduction.
double bounding_box_diagonal(const par::Comm& comm, const mesh::DistMesh& mesh);

/// Measures every patch, in the order of the mesh's patches. `tolerance` (length unit) is the distance beyond which a
/// node counts as off its surface. Areas are exact sums rounded once: the same bits for every number of ranks.
/// Collective: sparse exchanges of the off-surface nodes and reductions.
/// Cost: one distance per node and patch, and one normal per triangle, of this rank's boundary.
std::vector<PatchReport> measure_patches(const par::Comm& comm, const mesh::DistMesh& mesh, double tolerance);

/// Nodes that refinement could not bring onto their surface, from the nodal field `off_surface` (distance left, length
/// unit; 0: on it).
struct OffSurface {
  std::int64_t nodes = 0;
  double worst = 0;
};

/// Counts them; zeros when the mesh has no such field. A node on several ranks counts once. Collective.
OffSurface read_off_surface(const par::Comm& comm, const mesh::DistMesh& mesh);

}  // namespace pamr::check
