// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "meshing/meshing_domain.hpp"
#include "meshing/raw_mesh.hpp"

namespace pamr::meshing {

/// Puts every boundary node on its exact piece or curve. Returns the longest distance that a node moved. Local.
double place_boundary(const Domain& domain, RawMesh& mesh);

/// What `improve` aims at, and what it found and left.
struct QualityGoal {
  double wanted = 0.35;   ///< cells with a smaller mean ratio are worked on
  double required = 0.2;  ///< a cell with a smaller one at the end is an error
  int max_sweeps = 30;
};
struct Improvement {
  double min_before = 0, min_after = 0;  ///< mean ratio
  int moves = 0;
};

/// Raises the smallest mean ratios by moving the nodes of bad cells, one by one, to the best of a fixed set of nearby
/// places. Inner nodes come first; boundary nodes stay exactly on their piece or curve, corners do not move.
/// A node moves only if the worst cell at it gets better (so no cell gets worse than the worst at its nodes was) and,
/// on the boundary, if no edge to another boundary node gets too long. Local, deterministic.
/// Throws `Error` when a cell is not positive (exactly) or below the required mean ratio at the end.
Improvement improve(const Domain& domain, RawMesh& mesh, const QualityGoal& goal = {});

}  // namespace pamr::meshing
