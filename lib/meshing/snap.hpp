// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "meshing/meshing_domain.hpp"
#include "meshing/raw_mesh.hpp"

namespace pamr::meshing {

/// Puts every boundary node on its exact piece or curve. Local. Yields the longest way a node went.
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

/// Raises the smallest mean ratios by moving the nodes of bad cells, one by one in their order, to the best of a fixed
/// set of places near by; boundary nodes stay exactly on their piece or curve, corners stay. A move is made only when
/// the worst cell at the node gets better, so no cell ever gets worse than the worst of its neighbors was, and, on the
/// boundary, when no edge to another boundary node gets too long. Inner nodes first. Local, deterministic.
/// Throws `Error` when a cell is not positive (exactly) or below the required mean ratio at the end.
Improvement improve(const Domain& domain, RawMesh& mesh, const QualityGoal& goal = {});

}  // namespace pamr::meshing
