// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Rows of an array in global numbering, as one rank holds them.
struct HeldRows {
  IdRange all = 0;               ///< ids of all rows; row 0 of the array has the first
  std::size_t width = 1;         ///< words a row
  std::span<const GlobalId> id;  ///< of the rows held, ascending
  /// First id of the run of rows that each rank writes, and the end of the last run; empty: canonical blocks.
  std::span<const GlobalId> run;
  /// Writes the words of the `n` held rows from the `first` on, row after row.
  std::function<void(std::size_t first, std::size_t n, std::uint64_t* to)> fill;
};

/// True when each rank writes the rows that it holds: nothing travels.
inline bool stays(const HeldRows& rows) { return !rows.run.empty(); }

/// Ids of the rows that `rank` writes.
par::BlockRange rows_written(const HeldRows& rows, Rank rank, Rank size);

/// Those of them that it writes in step `step`, when a rank writes `slab` rows at once.
par::BlockRange window(const HeldRows& rows, Rank rank, Rank size, GlobalId step, GlobalId slab);

/// Rows on their way to the file: their words, in order. Used again and again, so that its memory is taken once.
struct Window {
  par::BlockRange range;  ///< ids
  std::vector<std::uint64_t> words;
  GlobalId missing = 0;       ///< rows that nobody holds
  std::vector<char> is_here;  ///< for `collect`
};

/// The rows in this rank's window from whichever ranks hold them. A row held by several ranks is taken from any of
/// them. Collective: one sparse exchange of the rows that are not where they are wanted.
void collect(const par::Comm& comm, const HeldRows& rows, GlobalId step, GlobalId slab, Window& result);

/// The rows `range` of those that this rank writes, where they stay. Local.
void take_own(const HeldRows& rows, par::BlockRange range, Window& result);

}  // namespace pamr::io
