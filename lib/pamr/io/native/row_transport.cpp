// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/row_transport.hpp"

#include <algorithm>

namespace pamr::io {

par::BlockRange rows_written(const HeldRows& rows, Rank rank, Rank size) {
  if (rows.run.empty()) return par::block_range(rows.all, rank, size);
  return {rows.run[static_cast<std::size_t>(rank)], rows.run[static_cast<std::size_t>(rank) + 1]};
}

par::BlockRange window(const HeldRows& rows, Rank rank, Rank size, GlobalId step, GlobalId slab) {
  const auto block = rows_written(rows, rank, size);
  const auto begin = std::min(block.begin + step * slab, block.end);
  return {begin, std::min(begin + slab, block.end)};
}

void take_own(const HeldRows& rows, par::BlockRange range, Window& result) {
  result.range = range;
  result.words.resize(static_cast<std::size_t>(range.count()) * rows.width);
  result.missing = range.count();
  const auto begin = std::lower_bound(rows.id.begin(), rows.id.end(), range.begin);
  const auto end = std::lower_bound(begin, rows.id.end(), range.end);
  for (auto first = begin; first != end;) {  // rows whose numbers follow one another in one go
    auto last = first + 1;
    while (last != end && *last == *first + (last - first)) ++last;
    const auto n = static_cast<std::size_t>(last - first);
    rows.fill(static_cast<std::size_t>(first - rows.id.begin()), n,
              result.words.data() + static_cast<std::size_t>(*first - range.begin) * rows.width);
    result.missing -= last - first;
    first = std::find_if(last, end, [&](GlobalId id) { return id > *(last - 1); });  // what is there already
  }
}

void collect(const par::Comm& comm, const HeldRows& rows, GlobalId step, GlobalId slab, Window& result) {
  const auto width = rows.width;
  result.range = window(rows, comm.rank(), comm.size(), step, slab);
  const auto n = static_cast<std::size_t>(result.range.count());
  result.words.resize(n * width);
  auto& is_here = result.is_here;
  is_here.assign(n, 0);
  std::vector<par::Outgoing<std::uint64_t>> messages;
  for (Rank rank = 0; rank < comm.size(); ++rank) {
    const auto wanted = window(rows, rank, comm.size(), step, slab);
    const auto begin = std::lower_bound(rows.id.begin(), rows.id.end(), wanted.begin);
    const auto end = std::lower_bound(begin, rows.id.end(), wanted.end);
    if (begin == end) continue;
    const auto first = static_cast<std::size_t>(begin - rows.id.begin()), count = static_cast<std::size_t>(end - begin);
    if (rank == comm.rank()) {
      for (std::size_t i = first; i < first + count; ++i) {
        const auto at = static_cast<std::size_t>(rows.id[i] - wanted.begin);
        rows.fill(i, 1, result.words.data() + at * width);
        is_here[at] = 1;
      }
      continue;
    }
    // A message is a row's id and its words, row after row.
    messages.push_back({rank, std::vector<std::uint64_t>(count * (width + 1))});
    auto* to = messages.back().item.data();
    for (std::size_t i = first; i < first + count; ++i, to += width + 1) {
      *to = static_cast<std::uint64_t>(rows.id[i]);
      rows.fill(i, 1, to + 1);
    }
  }
  const auto received = comm.sparse_exchange(messages);
  for (std::size_t i = 0; i + width < received.item.size(); i += width + 1) {
    const auto at = static_cast<std::size_t>(static_cast<GlobalId>(received.item[i]) - result.range.begin);
    std::copy_n(received.item.data() + i + 1, width, result.words.data() + at * width);
    is_here[at] = 1;
  }
  result.missing = std::count(is_here.begin(), is_here.end(), 0);
}

}  // namespace pamr::io
