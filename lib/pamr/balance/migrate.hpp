// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::balance {

/// The same mesh with every cell on the rank that `destination` names: `destination[i]` is the new rank of this rank's
/// cell `i`. Cells take along their nodes, neighbors, patches, lineage, all node and cell fields and, when given, one
/// byte each (`cell_byte`: n_cells values before, one for each new cell after). Members of a whole closure family have
/// the same destination.
///
/// Collective: one neighbor exchange of 4 bytes a border face (where the cells behind it go), one sparse exchange for
/// each eighth of an even share (128 to 2^18 cells) that the busiest rank sends, and one for as many bytes of each
/// field; cells that stay are not sent, and neighbors are linked without any directory. Result: a valid mesh if `mesh`
/// was, in the form that `assemble::assemble` gives (cells ascending, nodes in order of first use, border faces in the
/// order of their nodes); where nothing moves anywhere, `mesh` as it is. A rank that no cell leaves or comes to keeps
/// all but its border.
/// Throws `Error` on every rank for a destination that is no rank, families torn apart, or lists of the wrong length.
/// Cost: O(cells + moved cells log(moved cells)) time, and O(border) on a rank that no cell leaves or comes to; at the
/// peak the old cells of a rank with their fields, those that come to it without theirs, and an array of the new ones,
/// beside the messages of a round.
mesh::DistMesh migrate(const par::Comm& comm, mesh::DistMesh mesh, std::span<const Rank> destination,
                       std::vector<std::uint8_t>* cell_byte = nullptr);

}  // namespace pamr::balance
