// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "pamr/balance/join_pieces.hpp"
#include "pamr/mesh/field.hpp"
#include "pamr/par/comm.hpp"

/// The fields of cells that are on other ranks now. Private to `migrate`.
namespace pamr::balance {

/// Rows of cells, or of nodes, that go from rank to rank.
struct RowMoves {
  /// Rows that arrive with one piece.
  struct Arrival {
    Rank from = 0;
    LocalId n = 0;
  };
  std::vector<LocalId> sent;     ///< rows of this rank, those for one rank after those for another, ranks ascending
  std::vector<Rank> to;          ///< for each of `sent`
  std::vector<Arrival> arrived;  ///< of pieces 1, 2, ...; those of one rank in the order in which it sends the rows
  std::vector<RowRun> result;    ///< rows that are here from now on; piece 0: of this rank
};

/// Moves the values of fields, one field after another, so that no more than one of them is there twice. `fields` has
/// the same names and types on every rank; a rank where `result` is all that it had keeps its arrays. Collective: for
/// each field one sparse exchange for each `bytes_of_round` of it that the busiest rank sends.
std::vector<mesh::Field> move_fields(const par::Comm& comm, std::vector<mesh::Field> fields, const RowMoves& moves,
                                     std::size_t bytes_of_round);

}  // namespace pamr::balance
