// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::check {

/// What stands for a node that has no counterpart.
inline constexpr GlobalId unmatched = -1;

/// Nodes of a mesh that this rank holds; other ranks may hold the same ones, with the same coordinates.
struct NodeList {
  std::span<const GlobalId> number;          ///< in the whole mesh
  std::span<const geometry::Vec3> position;  ///< length unit
};

/// For each node of `nodes`, the node of `reference` that takes its place: one with the same coordinates, and where
/// there is none the nearest whose coordinates all differ by at most `tolerance`; the smallest number among equals;
/// `unmatched` when there is none. Matching a mesh with itself gives each node, or the first of those that lie in the
/// same place. Collective: four sparse exchanges, six reductions. Cost: O(n log n); with a tolerance also the number of
/// pairs of nodes that are within it in one coordinate.
std::vector<GlobalId> match_nodes(const par::Comm& comm, const NodeList& reference, const NodeList& nodes,
                                  double tolerance);

/// For each node the one that comes nearest to it of those with other numbers, as above. Collective: likewise.
std::vector<GlobalId> match_other_nodes(const par::Comm& comm, const NodeList& nodes, double tolerance);

}  // namespace pamr::check
