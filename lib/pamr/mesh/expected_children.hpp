// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace pamr::mesh {

/// Name of the cell field that says what refining by the marks of that name will cost in each cell, in cells that come
/// of it (1 to 255): who writes the marks may know it exactly (`adapt::Forecast`), and the mesh is then shared out by
/// it. Where it is missing or stale the result is the same and the ranks are less even.
inline std::string work_field(const std::string& marks_field) { return marks_field + "_work"; }

/// About how many cells each of a block of cells becomes when the marked ones are refined, from the block alone: eight
/// for a marked cell; for another one 2, 4 or 8 where two, three or four of its nodes are nodes of marked cells of the
/// block, else 1. Good enough to share a mesh out before it is put together (within 5 % on 16 ranks, 20 % on 64, for
/// the cone of tests/bench/scaling.sh); what it becomes exactly is known after `refine::close` only.
/// `cell_to_node`: n x 4, the lower halves of the node numbers; `marks`: n values, 1 for a marked cell. A hashed bit
/// for each node, so a few cells in a hundred may be taken for neighbors of marked ones that are none. Local. Memory:
/// 2 bytes a cell and a bit a node.
std::vector<std::uint8_t> expected_children(std::span<const std::array<std::uint32_t, 4>> cell_to_node,
                                            std::span<const std::uint8_t> marks);

}  // namespace pamr::mesh
