// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/certify.hpp"
#include "pamr/refine/movable.hpp"
#include "pamr/refine/new_level.hpp"

namespace pamr::refine {

/// Brings nodes to their targets with every cell exactly positive:
/// 1. the displacement is spread into this level's inner nodes (`smooth_displacement`);
/// 2. this level's nodes near bad cells move to better places (`untangle`);
/// 3. where a cell would still be inverted, its nodes go back (`certify`).
///
/// `position`: of every node of the level, those of `movables` at their targets; taken over. Collective.
Settled settle(const par::Comm& comm, const NewLevel& level, std::vector<geometry::Vec3> position,
               std::vector<Movable> movables);

}  // namespace pamr::refine
