// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/refine/options.hpp"
#include "support/reference_level0.hpp"
#include "support/reference_walls.hpp"

namespace pamr::test {

struct ReferenceRefinement {
  mesh::BlockMesh mesh;          ///< whole: cells, neighbors, patches, lineage, nodes; no fields
  std::vector<GlobalId> parent;  ///< the old cell that holds each new cell's centroid
  /// Of each new cell, while the new nodes of the last pass still lie in the middle of their edges.
  std::vector<geometry::Vec3> centroid;
  std::vector<GlobalId> from;  ///< the old cell that became each new one in the last pass, or its family's first
  std::int64_t families_rebuilt = 0;
  std::int64_t families_kept = 0;
  std::int64_t early_passes = 0;
  double largest_move = 0;  ///< of a new node from the middle of its edge, over the edge's length
  bool is_positive = true;  ///< every cell, exactly
  ReferenceLevel0 level0;   ///< of `mesh`
};

/// The slow, obvious twin of `adapt::refine`: one process, the whole mesh in one block, maps of edges and of faces, all
/// rules tried on all cells until nothing changes. Written from docs/closure.md and docs/level0-map.md, not from
/// the library's code.
///
/// `flags`: one for each cell. `shape_floor`: for the policy `removable`. `surface_of_patch`: one for each patch, null
/// where there is none; empty: all flat. `level0`: what the mesh is in a level 0 with a map; nothing where there is
/// none. The twin puts nodes onto surfaces but neither smooths nor backs off: where `largest_move` reaches 0.02 without
/// a map (smoothing) or `is_positive` is false (backing off, or no result at all) the two may differ. Cost: seconds for
/// 10,000 cells.
ReferenceRefinement reference_refine(const mesh::BlockMesh& whole, const std::vector<std::uint8_t>& flags,
                                     refine::QualityControl policy, double shape_floor,
                                     const SurfaceOfPatch& surface_of_patch = {}, const ReferenceLevel0& level0 = {});

}  // namespace pamr::test
