// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/balance/piece.hpp"

namespace pamr::balance {

/// One rank's mesh from the pieces that are there now: what stayed (of the first, the whole mesh that this rank had)
/// and what arrived. Cells ascending, nodes in order of first use, nodes and faces of several pieces joined, border
/// faces grouped by rank in the order of their nodes. `here`: this rank. Takes the pieces apart. `cell_byte` gets the
/// bytes of the cells, if the pieces have any. Does not set `info`. Local. Cost: O(cells + arrived cells log(arrived
/// cells) + border log(cells)).
mesh::DistMesh join_pieces(Rank here, std::vector<Piece> pieces, std::vector<std::uint8_t>& cell_byte);

}  // namespace pamr::balance
