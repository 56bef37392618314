// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "pamr/order/hilbert.hpp"
#include "pamr/order/order_along_curve.hpp"

/// The steps of `order_along_curve`. Private to the library.
namespace pamr::order {

/// Where the curve puts a cell.
inline std::uint64_t key_of(const CurveGrid& grid, const geometry::TetPoints& p) {
  return grid.key(0.25 * (p[0] + p[1] + p[2] + p[3]));
}

/// Orders a mesh that lies on this rank alone. Local.
Ordered order_here(mesh::BlockMesh block, const CurveGrid& grid);

/// Orders a mesh over all ranks. Collective.
Ordered order_over_ranks(const par::Comm& comm, mesh::BlockMesh block, const CurveGrid& grid);

/// The new number of each cell of the block: its place among all cells by key, then by old number. `key` has one entry
/// for each cell of the block. Collective: a sample sort.
std::vector<GlobalId> places_along_curve(const par::Comm& comm, const mesh::BlockMesh& block,
                                         std::span<const std::uint64_t> key);

/// The nodes that cells name, in order of first use, and each corner's place among them.
struct Named {
  std::vector<GlobalId> node;
  std::vector<LocalId> corner;  ///< 4 a cell
};

/// Local.
Named find_named(const std::vector<std::array<GlobalId, 4>>& cell_to_node);

/// Numbers the nodes in the order in which the cells name them, moves positions and fields to their new blocks and
/// returns what the numbers were before. `block` holds the cells in canonical blocks, with old node numbers.
/// Collective.
std::vector<GlobalId> renumber_nodes(const par::Comm& comm, mesh::BlockMesh& block);

}  // namespace pamr::order
