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
  /// Writes the `width` words of held row `i`.
  std::function<void(std::size_t i, std::uint64_t* to)> fill;
};

/// Ids of the rows that `rank` writes.
par::BlockRange rows_written(const HeldRows& rows, Rank rank, Rank size);

/// Those of them that it writes in step `step`, when a rank writes `slab` rows at once.
par::BlockRange window(const HeldRows& rows, Rank rank, Rank size, GlobalId step, GlobalId slab);

/// The words of the rows in this rank's window, in order, from whichever ranks hold them. A row held by several ranks
/// is taken from any of them. `missing` is the number of rows that nobody holds. Collective: one sparse exchange of the
/// rows that are not where they are wanted.
struct Window {
  par::BlockRange range;  ///< ids
  std::vector<std::uint64_t> words;
  GlobalId missing = 0;
};
Window collect(const par::Comm& comm, const HeldRows& rows, GlobalId step, GlobalId slab);

}  // namespace pamr::io
