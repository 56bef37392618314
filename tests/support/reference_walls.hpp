// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "support/reference_split.hpp"

/// Walls of `reference_refine`: where the middles of edges in them belong, and what is bent in a level 0 that is coarse
/// for them.
namespace pamr::test {

using SurfaceOfPatch = std::vector<const geometry::Surface*>;  ///< of each patch, null where there is none

/// A boundary face at an edge: its patch and its third corner.
struct FaceAtEdge {
  int patch = 0;
  GlobalId third = 0;
};

/// The boundary faces at each edge in the boundary, ascending by patch.
std::map<Edge, std::vector<FaceAtEdge>> faces_at_edges(const std::vector<Piece>& cell);

/// Where the middle of an edge in a curved wall belongs.
struct WallTarget {
  geometry::Vec3 point;
  geometry::Vec3 beside{};  ///< normal of the face of a patch without a surface at the edge, else 0
  bool is_sharp = false;    ///< that face and the wall meet at 40 degrees or more: the middle keeps to its plane
};
/// Nothing where all surfaces are flat, which move nothing.
std::optional<WallTarget> target_in_wall(const Edge& edge, const std::vector<FaceAtEdge>& faces,
                                         const SurfaceOfPatch& surface_of_patch, const Points& point);

/// The rows of the map of a level 0, but for the bulges of edges that are in no curved wall. For surfaces without sharp
/// edges inside. None where no edge is coarse.
std::vector<mesh::Level0Cell> reference_rows(const mesh::BlockMesh& whole, const SurfaceOfPatch& surface_of_patch);

}  // namespace pamr::test
