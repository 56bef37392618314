// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/movable.hpp"
#include "pamr/refine/number.hpp"

namespace pamr::refine {

/// The nodes of the refined mesh: the old ones as they are numbered now, then the new ones.
struct FineNodes {
  std::vector<geometry::Vec3> position;
  std::vector<GlobalId> global;
  par::Pattern shared;  ///< those that other ranks hold too
};

/// Puts every node where it is meant to lie: old ones where they are, new ones in the middle of their edge, those of
/// `movables` at their targets. Local. Cost: O(nodes).
FineNodes place_nodes(const NumberedMesh& old, const mesh::Borders& borders, const std::vector<Movable>& movables);

}  // namespace pamr::refine
