// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "pamr/base/memory.hpp"
#include "pamr/base/prefetch.hpp"
#include "pamr/mesh/block_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::order {

/// The way of all cells to the canonical blocks of their new numbers, which are their places by key, then by old number.
struct Route {
  std::vector<std::uint32_t> order;  ///< the cells of this rank by key, then by number
  std::vector<std::size_t> begin;    ///< size + 1: those for rank `r` are `order[begin[r] .. begin[r + 1])`
  std::vector<std::uint32_t> place;  ///< of the cells that come, as their ranks order them: rows in this rank's block
  std::vector<std::size_t> first;    ///< size + 1: those from rank `r` are `place[first[r] .. first[r + 1])`
  std::int64_t rounds = 0;           ///< of messages: a rank sends about 2^17 rows in each at most
};

/// `key` has one entry for each cell of the block. Collective: one sparse exchange, and a reduction of 16 numbers a rank
/// for each four bits of a key and of a number.
Route find_route(const par::Comm& comm, const mesh::BlockMesh& block, std::span<const std::uint64_t> key);

/// The new number of each cell that this rank had before, in their old order. Collective: one sparse exchange.
std::vector<GlobalId> new_numbers(const par::Comm& comm, const Route& route, IdRange cells);

/// Replaces `rows`, `width` values for each cell that this rank had before, by those of the cells of its new block.
/// Collective: a sparse exchange for each round.
template <class T>
void send_rows(const par::Comm& comm, const Route& route, std::vector<T>& rows, std::size_t width) {
  constexpr std::size_t rows_ahead = 24;
  const auto size = static_cast<std::size_t>(comm.size()), here = static_cast<std::size_t>(comm.rank());
  std::vector<T> result;
  assign_array(result, route.place.size() * width, T{});
  const auto row_of = [&](std::size_t i) {
    if (i + rows_ahead < route.order.size()) prefetch(&rows[route.order[i + rows_ahead] * width]);
    return rows.begin() + static_cast<std::ptrdiff_t>(route.order[i] * width);
  };
  const auto put = [&](auto row, std::size_t i) {
    std::copy_n(row, width, result.begin() + static_cast<std::ptrdiff_t>(route.place[i] * width));
  };
  for (auto i = route.begin[here]; i < route.begin[here + 1]; ++i)
    put(row_of(i), route.first[here] + i - route.begin[here]);
  auto next = route.first;
  for (std::int64_t round = 0; round < route.rounds; ++round) {
    std::vector<par::Outgoing<T>> messages;
    for (std::size_t r = 0; r < size; ++r) {
      const auto n = route.begin[r + 1] - route.begin[r], parts = static_cast<std::size_t>(route.rounds);
      const auto of_round = static_cast<std::size_t>(round);
      const auto begin = route.begin[r] + n * of_round / parts, end = route.begin[r] + n * (of_round + 1) / parts;
      if (r == here || begin == end) continue;
      auto& out = messages.emplace_back(par::Outgoing<T>{static_cast<Rank>(r), {}}).item;
      reserve_array(out, (end - begin) * width);
      for (auto i = begin; i < end; ++i) {
        const auto row = row_of(i);
        out.insert(out.end(), row, row + static_cast<std::ptrdiff_t>(width));
      }
    }
    const auto arrived = comm.sparse_exchange(messages);
    for (std::size_t k = 0; k < arrived.rank.size(); ++k) {
      const auto from = arrived.from(k);
      auto& i = next[static_cast<std::size_t>(arrived.rank[k])];
      for (auto row = from.begin(); row != from.end(); row += static_cast<std::ptrdiff_t>(width)) put(row, i++);
    }
  }
  rows = std::move(result);
}

}  // namespace pamr::order
