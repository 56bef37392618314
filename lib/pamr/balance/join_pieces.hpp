// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pamr/balance/piece.hpp"

namespace pamr::balance {

/// Rows of a piece that follow each other in the joined mesh, too.
struct RowRun {
  std::uint32_t piece = 0;
  LocalId first = 0, n = 0;
};

std::size_t count_rows(std::span<const RowRun> runs);

/// A mesh made of pieces, and where its rows come from: cells, nodes.
struct Joined {
  mesh::DistMesh mesh;
  std::vector<RowRun> cells, nodes;
};

/// One rank's mesh from the pieces that are there now: what stayed (of the first, the whole mesh that this rank had)
/// and what arrived. Cells ascending, nodes in order of first use, nodes and faces of several pieces joined, border
/// faces grouped by rank in the order of their nodes. `here`: this rank. Takes the pieces apart. `cell_byte` gets the
/// bytes of the cells, if the pieces have any. Sets neither `info` nor fields. Local. Cost: O(cells + arrived cells
/// log(arrived cells) + border log(cells)).
Joined join_pieces(Rank here, std::vector<Piece> pieces, std::vector<std::uint8_t>& cell_byte);

}  // namespace pamr::balance
