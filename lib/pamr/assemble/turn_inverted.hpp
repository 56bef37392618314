// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "pamr/base/exact.hpp"
#include "pamr/mesh/block_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::assemble {

/// Cells of all ranks whose volume was not positive; the same on every rank.
struct TurnedCells {
  std::int64_t n_turned = 0;  ///< negative volume: their last two corners were exchanged
  std::int64_t n_flat = 0;    ///< no volume: left as they are
};

/// Turns inverted cells over, by exact predicates: many programs do not care for the order of a tetrahedron's corners.
/// Collective: two sparse exchanges, one reduction. O(cells). Throws `Error` on every rank for node numbers out of
/// range and a block of nodes of the wrong size. Pre: finite coordinates, no closure families.
TurnedCells turn_inverted(const par::Comm& comm, mesh::BlockMesh& block);

/// The same for sources that do care: turns the inverted cells over where all are, because the source has the other
/// order of corners, and where `repair` asks for it. Collective. Throws `Error` on every rank, with the counts, for
/// other meshes with inverted cells; not where there are flat ones, which the caller has to refuse.
TurnedCells orient(const par::Comm& comm, mesh::BlockMesh& block, Exact<bool> repair);

}  // namespace pamr::assemble
