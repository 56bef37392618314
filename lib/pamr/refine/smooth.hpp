// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/movable.hpp"
#include "pamr/refine/new_level.hpp"

namespace pamr::refine {

/// Largest displacement of a boundary node relative to its edge under which the inner nodes need not follow.
inline constexpr double gentle_ratio = 0.02;

/// The nodes that follow the boundary.
struct Smoothed {
  std::vector<Movable> followers;
  double max_ratio = 0;       ///< largest displacement of a new boundary node relative to its edge, over all ranks
  bool reaches_open = false;  ///< nodes beyond the level's open nodes would follow, or hand it on
};

/// Spreads the displacement of the boundary nodes into this level's inner nodes near them (within three cells of one
/// that moves by 2 % of its edge or more), so that the cells behind a curved wall follow it.
///
/// `position`: of every node of the level, inner ones in the middle of their edges. Averages over the cells at a node,
/// all nodes at once (Jacobi), with old nodes fixed; sums are in 64-bit fixed point, so that neither order nor ranks
/// change a bit. New nodes within a patch on a plane follow in the plane, held ones stay. The number of sweeps depends
/// on the largest displacement relative to its edge: none under 2 %, 10 up to 10 %, 30 beyond. Collective: two
/// reductions, and one neighbor exchange a sweep over the shared nodes that may follow.
Smoothed smooth_displacement(const par::Comm& comm, const NewLevel& level, const std::vector<geometry::Vec3>& position,
                             const Movement& movement);

}  // namespace pamr::refine
