// SPDX-License-Identifier: GPL-3.0-or-later
// Templates of exchange.hpp.
#pragma once

#include <algorithm>

#include "pamr/base/contract.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::par {

namespace detail {

/// Indices of `ids` grouped by the block that holds them.
inline std::vector<Outgoing<std::size_t>> group_by_block(IdRange all, Rank size, std::span<const GlobalId> ids) {
  std::vector<std::size_t> count(static_cast<std::size_t>(size), 0);
  for (const auto id : ids) ++count[static_cast<std::size_t>(block_of(id, all, size))];
  std::vector<Outgoing<std::size_t>> groups;
  std::vector<std::size_t> group_of(static_cast<std::size_t>(size), 0);
  for (Rank r = 0; r < size; ++r) {
    const auto c = count[static_cast<std::size_t>(r)];
    if (c == 0) continue;
    group_of[static_cast<std::size_t>(r)] = groups.size();
    groups.push_back({r, {}});
    groups.back().item.reserve(c);
  }
  for (std::size_t i = 0; i < ids.size(); ++i)
    groups[group_of[static_cast<std::size_t>(block_of(ids[i], all, size))]].item.push_back(i);
  return groups;
}

}  // namespace detail

template <class T>
std::vector<T> fetch_rows(const Comm& comm, IdRange all, std::span<const T> rows, Exact<std::size_t> width,
                          std::span<const GlobalId> ids) {
  const auto begin = block_range(all, comm.rank(), comm.size()).begin;
  const auto groups = detail::group_by_block(all, comm.size(), ids);
  std::vector<Outgoing<GlobalId>> questions;
  for (const auto& group : groups) {
    questions.push_back({group.to, {}});
    questions.back().item.reserve(group.item.size());
    for (const auto i : group.item) questions.back().item.push_back(ids[i]);
  }
  const auto asked = comm.sparse_exchange(questions);
  std::vector<Outgoing<T>> answers;
  for (std::size_t r = 0; r < asked.rank.size(); ++r) {
    answers.push_back({asked.rank[r], {}});
    auto& out = answers.back().item;
    out.reserve(asked.from(r).size() * width);
    for (const auto id : asked.from(r)) {
      const auto row = rows.subspan(static_cast<std::size_t>(id - begin) * width, width);
      out.insert(out.end(), row.begin(), row.end());
    }
  }
  const auto answered = comm.sparse_exchange(answers);
  std::vector<T> result(ids.size() * width);
  for (std::size_t r = 0; r < answered.rank.size(); ++r) {
    const auto group =
        std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.to == answered.rank[r]; });
    PAMR_ENSURES(group != groups.end() && answered.from(r).size() == group->item.size() * width);
    for (std::size_t k = 0; k < group->item.size(); ++k)
      std::copy_n(answered.from(r).begin() + static_cast<std::ptrdiff_t>(k * width), std::size_t{width},
                  result.begin() + static_cast<std::ptrdiff_t>(group->item[k] * width));
  }
  return result;
}

template <class T>
std::vector<T> scatter_rows(const Comm& comm, IdRange all, std::span<const T> rows, Exact<std::size_t> width,
                            std::span<const GlobalId> ids) {
  std::vector<T> block(static_cast<std::size_t>(block_range(all, comm.rank(), comm.size()).count()) * width);
  scatter_rows_into<T>(comm, all, rows.first(ids.size() * width), ids, block);
  return block;
}

template <class T>
void scatter_rows_into(const Comm& comm, IdRange all, std::span<const T> rows, std::span<const GlobalId> ids,
                       std::span<T> block) {
  const auto width = ids.empty() ? 0 : rows.size() / ids.size();
  const auto range = block_range(all, comm.rank(), comm.size());
  std::vector<Outgoing<GlobalId>> to_ids;
  std::vector<Outgoing<T>> to_rows;
  for (const auto& group : detail::group_by_block(all, comm.size(), ids)) {
    to_ids.push_back({group.to, {}});
    to_rows.push_back({group.to, {}});
    to_ids.back().item.reserve(group.item.size());
    to_rows.back().item.reserve(group.item.size() * width);
    for (const auto i : group.item) {
      to_ids.back().item.push_back(ids[i]);
      const auto row = rows.subspan(i * width, width);
      to_rows.back().item.insert(to_rows.back().item.end(), row.begin(), row.end());
    }
  }
  const auto at = comm.sparse_exchange(to_ids);
  const auto values = comm.sparse_exchange(to_rows);
  for (std::size_t r = 0; r < at.rank.size(); ++r) {
    const auto n = values.from(r).size() / at.from(r).size();  // this rank may have no rows of its own to tell
    for (std::size_t k = 0; k < at.from(r).size(); ++k)
      std::copy_n(
          values.from(r).begin() + static_cast<std::ptrdiff_t>(k * n), n,
          block.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(at.from(r)[k] - range.begin) * n));
  }
}

}  // namespace pamr::par
