// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::diff {

/// What stands for a node that has no counterpart.
inline constexpr GlobalId unmatched = -1;

/// This rank's part of the nodes of a mesh: any part, as long as every node is on one rank.
struct NodeBlock {
  GlobalId first = 0;                        ///< global number of the first; the others follow it
  std::span<const geometry::Vec3> position;  ///< length unit
};

/// For each node of `nodes`, the node of `reference` that takes its place: one with the same coordinates, and where
/// there is none the nearest whose coordinates all differ by at most `tolerance`; the smallest number among equals;
/// `unmatched` when there is none. Matching a mesh with itself gives each node, or the first of those that lie in the
/// same place. Collective: four sparse exchanges, six reductions. Cost: O(n log n); with a tolerance also the number of
/// pairs of nodes that are within it in one coordinate.
std::vector<GlobalId> match_nodes(const par::Comm& comm, const NodeBlock& reference, const NodeBlock& nodes,
                                  double tolerance);

}  // namespace pamr::diff
