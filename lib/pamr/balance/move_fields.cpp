// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/move_fields.hpp"

#include <algorithm>
#include <map>
#include <variant>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::balance {

namespace {

/// Where rows that arrive are kept: those of each rank together.
struct Shelves {
  std::map<Rank, std::size_t> of_rank;  ///< first row from this rank
  std::vector<std::size_t> of_piece;    ///< first row of each arrival
  std::size_t n_rows = 0;
};

Shelves shelves_of(const std::vector<RowMoves::Arrival>& arrived) {
  Shelves shelves;
  for (const auto& [from, n] : arrived) shelves.of_rank[from] += at(n);
  for (auto& [from, first] : shelves.of_rank) {
    const auto n = first;
    first = shelves.n_rows;
    shelves.n_rows += n;
  }
  auto next = shelves.of_rank;
  for (const auto& [from, n] : arrived) {
    shelves.of_piece.push_back(next[from]);
    next[from] += at(n);
  }
  return shelves;
}

/// Sends the values of the departing rows; returns those that arrive, on their shelves.
template <class T>
std::vector<T> exchange_rows(const par::Comm& comm, const std::vector<T>& values, std::size_t width,
                             const RowMoves& moves, const Shelves& shelves, std::size_t rows_of_round) {
  std::vector<T> arrived;
  assign_array(arrived, shelves.n_rows * width, T{});
  auto next = shelves.of_rank;
  par::in_rounds(comm, moves.sent.size(), rows_of_round, [&](std::size_t begin, std::size_t end) {
    std::vector<par::Outgoing<T>> messages;
    for (; begin < end; ++begin) {
      if (messages.empty() || messages.back().to != moves.to[begin]) messages.push_back({moves.to[begin], {}});
      const auto* row = values.data() + at(moves.sent[begin]) * width;
      messages.back().item.insert(messages.back().item.end(), row, row + width);
    }
    const auto received = comm.sparse_exchange(messages);
    for (std::size_t r = 0; r < received.rank.size(); ++r) {
      const auto rows = received.from(r);
      auto& row = next.at(received.rank[r]);
      PAMR_EXPECTS(row * width + rows.size() <= arrived.size());
      std::copy(rows.begin(), rows.end(), arrived.begin() + static_cast<std::ptrdiff_t>(row * width));
      row += rows.size() / width;
    }
  });
  return arrived;
}

template <class T>
std::vector<T> put_together(const std::vector<T>& own, const std::vector<T>& arrived, std::size_t width,
                            const std::vector<RowRun>& runs, const Shelves& shelves) {
  std::vector<T> all;
  reserve_array(all, count_rows(runs) * width);
  for (const auto& [piece, first, n] : runs) {
    const auto row = at(first) + (piece == 0 ? 0 : shelves.of_piece[piece - 1]);
    const auto* from = (piece == 0 ? own : arrived).data() + row * width;
    all.insert(all.end(), from, from + at(n) * width);
  }
  return all;
}

}  // namespace

std::vector<mesh::Field> move_fields(const par::Comm& comm, std::vector<mesh::Field> fields, const RowMoves& moves,
                                     std::size_t bytes_of_round) {
  const auto shelves = shelves_of(moves.arrived);
  const auto is_all_of = [&](std::size_t n_rows) {
    const auto& runs = moves.result;
    return n_rows == 0 ? runs.empty()
                       : runs.size() == 1 && runs[0].piece == 0 && runs[0].first == 0 && at(runs[0].n) == n_rows;
  };
  for (auto& field : fields)
    std::visit(
        [&]<class T>(std::vector<T>& values) {
          const auto width = at(field.n_components);
          const auto rows_of_round = std::max<std::size_t>(1, bytes_of_round / (width * sizeof(T)));
          const auto arrived = exchange_rows(comm, values, width, moves, shelves, rows_of_round);
          if (!is_all_of(values.size() / width)) values = put_together(values, arrived, width, moves.result, shelves);
        },
        field.value);
  return fields;
}

}  // namespace pamr::balance
