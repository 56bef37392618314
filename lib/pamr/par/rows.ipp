// SPDX-License-Identifier: GPL-3.0-or-later
// Templates of exchange.hpp.
#pragma once

#include <algorithm>
#include <utility>

#include "pamr/base/contract.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::par {

namespace detail {

/// Indices of `ids` grouped by the block that holds them, without those in `own`.
inline std::vector<Outgoing<std::size_t>> group_by_block(IdRange all, Rank size, std::span<const GlobalId> ids,
                                                         BlockRange own = {}) {
  std::vector<std::size_t> count(static_cast<std::size_t>(size), 0);
  for (const auto id : ids)
    if (!own.contains(id)) ++count[static_cast<std::size_t>(block_of(id, all, size))];
  std::vector<Outgoing<std::size_t>> groups;
  std::vector<std::size_t> group_of(static_cast<std::size_t>(size), 0);
  for (Rank r = 0; r < size; ++r) {
    const auto c = count[static_cast<std::size_t>(r)];
    if (c == 0) continue;
    group_of[static_cast<std::size_t>(r)] = groups.size();
    groups.push_back({r, {}});
    reserve_array(groups.back().item, c);
  }
  if (groups.empty()) return groups;
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (!own.contains(ids[i]))
      groups[group_of[static_cast<std::size_t>(block_of(ids[i], all, size))]].item.push_back(i);
  return groups;
}

/// Copies `width` values from row `from` of `source` to row `to` of `target`. Most rows have one.
template <class T>
void copy_row(std::span<const T> source, std::size_t from, std::span<T> target, std::size_t to, std::size_t width) {
  if (width == 1)
    target[to] = source[from];
  else
    std::copy_n(source.begin() + static_cast<std::ptrdiff_t>(from * width), width,
                target.begin() + static_cast<std::ptrdiff_t>(to * width));
}

}  // namespace detail

template <class T>
std::vector<T> fetch_rows(const Comm& comm, IdRange all, std::span<const T> rows, Exact<std::size_t> width,
                          std::span<const GlobalId> ids) {
  const auto own = block_range(all, comm.rank(), comm.size());
  const auto groups = detail::group_by_block(all, comm.size(), ids, own);
  std::vector<Outgoing<GlobalId>> questions;
  for (const auto& group : groups) {
    questions.push_back({group.to, {}});
    reserve_array(questions.back().item, group.item.size());
    for (const auto i : group.item) questions.back().item.push_back(ids[i]);
  }
  const auto asked = comm.sparse_exchange(questions);
  std::vector<Outgoing<T>> answers;
  for (std::size_t r = 0; r < asked.rank.size(); ++r) {
    answers.push_back({asked.rank[r], {}});
    auto& out = answers.back().item;
    reserve_array(out, asked.from(r).size() * width);
    for (const auto id : asked.from(r)) {
      const auto row = rows.subspan(static_cast<std::size_t>(id - own.begin) * width, width);
      out.insert(out.end(), row.begin(), row.end());
    }
  }
  const auto answered = comm.sparse_exchange(answers);
  std::vector<T> result;
  assign_array(result, ids.size() * width, T{});
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (own.contains(ids[i])) detail::copy_row<T>(rows, static_cast<std::size_t>(ids[i] - own.begin), result, i, width);
  for (std::size_t r = 0; r < answered.rank.size(); ++r) {
    const auto group =
        std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.to == answered.rank[r]; });
    PAMR_ENSURES(group != groups.end() && answered.from(r).size() == group->item.size() * width);
    for (std::size_t k = 0; k < group->item.size(); ++k)
      detail::copy_row<T>(answered.from(r), k, result, group->item[k], width);
  }
  return result;
}

template <class T>
std::vector<T> scatter_rows(const Comm& comm, IdRange all, std::span<const T> rows, Exact<std::size_t> width,
                            std::span<const GlobalId> ids) {
  std::vector<T> block;
  assign_array(block, static_cast<std::size_t>(block_range(all, comm.rank(), comm.size()).count()) * width, T{});
  scatter_rows_into<T>(comm, all, rows.first(ids.size() * width), ids, block);
  return block;
}

template <class T>
void scatter_rows_into(const Comm& comm, IdRange all, std::span<const T> rows, std::span<const GlobalId> ids,
                       std::span<T> block) {
  const auto width = ids.empty() ? 0 : rows.size() / ids.size();
  const auto own = block_range(all, comm.rank(), comm.size());
  std::vector<Outgoing<GlobalId>> to_ids;
  std::vector<Outgoing<T>> to_rows;
  for (const auto& group : detail::group_by_block(all, comm.size(), ids, own)) {
    to_ids.push_back({group.to, {}});
    to_rows.push_back({group.to, {}});
    reserve_array(to_ids.back().item, group.item.size());
    reserve_array(to_rows.back().item, group.item.size() * width);
    for (const auto i : group.item) {
      to_ids.back().item.push_back(ids[i]);
      const auto row = rows.subspan(i * width, width);
      to_rows.back().item.insert(to_rows.back().item.end(), row.begin(), row.end());
    }
  }
  const auto at = comm.sparse_exchange(to_ids);
  const auto values = comm.sparse_exchange(to_rows);
  const auto copy_own = [&] {
    for (std::size_t i = 0; i < ids.size(); ++i)
      if (own.contains(ids[i]))
        detail::copy_row<T>(rows, i, block, static_cast<std::size_t>(ids[i] - own.begin), width);
  };
  bool is_own_done = false;
  for (std::size_t r = 0; r < at.rank.size(); ++r) {
    if (at.rank[r] > comm.rank() && !std::exchange(is_own_done, true)) copy_own();
    const auto n = values.from(r).size() / at.from(r).size();  // this rank may have no rows of its own to tell
    for (std::size_t k = 0; k < at.from(r).size(); ++k)
      detail::copy_row<T>(values.from(r), k, block, static_cast<std::size_t>(at.from(r)[k] - own.begin), n);
  }
  if (!is_own_done) copy_own();
}

}  // namespace pamr::par
