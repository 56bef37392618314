// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/options.hpp"

namespace pamr::curved {

/// Edges in curved walls that are longer than 0.2 of the radius of curvature.
struct CoarseEdges {
  std::int64_t count = 0;                ///< over all ranks
  double longest = 0;                    ///< the longest, in its radius of curvature
  geometry::Vec3 where;                  ///< its middle; of several the first by coordinates
  std::vector<std::uint8_t> is_at_cell;  ///< 1 for each cell of this rank that has such an edge
};

/// Beyond this length in radii a map of level 0 need not keep shapes (docs/reports/curved-walls.md).
inline constexpr double longest_kept = 1.06;

/// Those of a mesh of level 0; none of one that was refined. The same on any ranks and for any numbering. Collective: as
/// giving every edge a node, and seven reductions.
CoarseEdges find_coarse_edges(const par::Comm& comm, const mesh::DistMesh& mesh);

/// What to tell a user of them before anything is split; empty where there are none.
std::string text_of(const CoarseEdges& coarse);

/// Whether all cells are of level 0 and an edge in a curved wall may be coarse for it, or all edges shall bend.
/// Collective: two reductions.
bool needs_level0_map(const par::Comm& comm, const mesh::DistMesh& mesh, refine::Bend bend);

/// What to tell a user of a mesh without a map that was refined while its walls are coarse still, as files of older
/// versions may have it; empty for others. Looks at 50,000 cells of a larger mesh, the same ones on any ranks.
/// Collective: two reductions.
std::string trouble_without_map(const par::Comm& comm, const mesh::DistMesh& mesh);

}  // namespace pamr::curved
