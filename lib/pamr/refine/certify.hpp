// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/movable.hpp"
#include "pamr/refine/new_level.hpp"

namespace pamr::refine {

/// A boundary node that does not lie where it belongs, and how far it is from there.
struct OffSurface {
  LocalId node = invalid_local;
  double distance = 0;
};

/// What came of the movement. Counts are over all ranks.
struct Certificate {
  std::vector<OffSurface> off_surface;  ///< this rank's nodes that are off their surfaces, ascending
  std::int64_t n_off_surface = 0;       ///< each node once
  /// This rank's nodes that left the faces of a patch without a surface, ascending, and how far.
  std::vector<OffSurface> off_facets;
  std::int64_t n_off_facets = 0;     ///< each node once
  std::int64_t n_moved = 0;          ///< nodes that do not lie where they would without surfaces, each once
  std::int64_t n_cells_checked = 0;  ///< found exactly positive; not counted where nothing moves
  int back_off_rounds = 0;
};

/// Where the nodes of the refined mesh lie at last.
struct Settled {
  std::vector<geometry::Vec3> position;
  Certificate certificate;
};

/// Moves nodes as far towards their targets as no cell is inverted: starts with all of the way, and where a cell is not
/// positive by exact arithmetic takes back half of what its nodes moved, again and again, at last all of it.
///
/// `position`: of every node of the level, taken over. Afterwards every cell with one of `movables` and every suspect of
/// `level.children` is exactly positive, given that they are so when nothing moves; otherwise throws `Error` on every
/// rank. Depends on neither order nor ranks.
/// Collective: one reduction, and one neighbor exchange and one reduction a round.
Settled certify(const par::Comm& comm, const NewLevel& level, std::vector<geometry::Vec3> position,
                const std::vector<Movable>& movables);

}  // namespace pamr::refine
