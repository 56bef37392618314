// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"

/// Parts of a rank's mesh on their way. Private to `migrate`.
namespace pamr::balance {

/// Some cells of a mesh with the nodes they use, as a little mesh: a neighbor slot holds a cell of the piece, a ghost
/// (n_cells + k: cell `ghost_global[k]`, which goes to rank `ghost_to[k]`) or a boundary patch. The lists of border
/// ranks and faces are empty, and so are the fields, which follow by themselves (`move_fields`).
struct Piece {
  mesh::DistMesh mesh;
  std::vector<Rank> ghost_to;
  std::vector<std::uint8_t> cell_byte;  ///< n_cells, or empty
  /// n_cells, or empty. A rank's whole mesh as a piece, of which the cells that go elsewhere are no part: where each
  /// cell goes.
  std::span<const Rank> destination;

  /// Whether a cell of the piece's mesh is on rank `here` from now on.
  bool is_on(Rank here, LocalId cell) const {
    return destination.empty() || destination[static_cast<std::size_t>(cell)] == here;
  }
};

/// Cuts pieces out of a mesh, whose arrays have to outlive it. `destination`: of each cell; `ghost_to`: of the cell
/// behind each border face; `cell_byte` may be empty. Costs O(cells + nodes) once and O(cells of the piece) each.
class PieceCutter {
 public:
  PieceCutter(const mesh::DistMesh& mesh, std::span<const Rank> destination, std::span<const Rank> ghost_to,
              std::span<const std::uint8_t> cell_byte);
  /// `cells` ascend. Appends to `nodes` the numbers that the nodes of the piece have in the mesh, in the piece's order.
  Piece cut(std::span<const LocalId> cells, std::vector<LocalId>& nodes);

 private:
  void cut_neighbors(std::span<const LocalId> cells, Piece& piece);
  void cut_nodes(std::span<const LocalId> cells, Piece& piece, std::vector<LocalId>& nodes);

  const mesh::DistMesh* mesh_;
  std::span<const Rank> destination_;
  std::span<const Rank> ghost_to_;
  std::span<const std::uint8_t> cell_byte_;
  std::vector<LocalId> cell_to_piece_;  // of the piece at hand, else `invalid_local`
  std::vector<LocalId> node_to_piece_;
};

/// A piece as bytes and back.
std::vector<std::byte> pack(const Piece& piece);
Piece unpack(std::span<const std::byte> bytes);

}  // namespace pamr::balance
