// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/movable.hpp"

namespace pamr::refine {

/// What came of the movement.
struct Certificate {
  std::vector<OffSurface> ledger;  ///< this rank's nodes that are off their surfaces, ascending
  std::int64_t n_off_surface = 0;  ///< all ranks, each node once
  int rounds = 0;                  ///< of backing off
  int untangling_rounds = 0;
  std::int64_t n_moved = 0;          ///< nodes that do not lie where they would without surfaces, each once
  std::int64_t n_cells_checked = 0;  ///< all ranks; not counted where nothing moves
};

/// This rank's cells with a node of `movables`, ascending.
std::vector<LocalId> cells_with_moved_nodes(const mesh::DistMesh& fine, const std::vector<Movable>& movables);

/// Moves the nodes of `movables` in `fine` as far towards their targets as no cell turns over: starts with all of it,
/// and where a cell is not positive by exact arithmetic takes back half of what its nodes moved, again and again, at
/// last all of it. `any_moves`: some rank has such nodes. `moved_cells`: those with a node of `movables`. Afterwards
/// every one of them and of `suspects` is exactly positive, given that they are so when nothing moves; otherwise throws
/// `Error` on every rank. `shared`: nodes of the refined mesh that other ranks hold too. Collective: one neighbor
/// exchange and one reduction a round. Depends on neither order nor ranks.
Certificate certify(const par::Comm& comm, mesh::DistMesh& fine, const par::Pattern& shared,
                    const geometry::SurfaceSet& surfaces, const std::vector<Movable>& movables, bool any_moves,
                    const std::vector<LocalId>& moved_cells, std::span<const LocalId> suspects);

}  // namespace pamr::refine
