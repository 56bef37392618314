// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "pamr/par/comm.hpp"

namespace pamr::io {

/// How many lines end before each chunk of a text that every rank has before it: where a line begins is then found
/// without running through what comes before it. 8 bytes a chunk.
class LineIndex {
 public:
  static constexpr std::size_t default_chunk = std::size_t{1} << 20U;

  /// Counts in parallel, each rank in its part of the chunks. Collective: one reduction. `bytes` must be the same on
  /// every rank, and outlive the index.
  LineIndex(const par::Comm& comm, std::string_view bytes, std::size_t chunk = default_chunk);

  /// The place after the n-th end of a line behind `from`, n > 0; npos when there are fewer. Local; looks at two
  /// chunks.
  std::size_t after_lines(std::size_t from, std::int64_t n) const;

 private:
  std::string_view bytes_;
  std::size_t chunk_;
  std::vector<std::int64_t> before_;  ///< line ends before each chunk, and before the end
};

}  // namespace pamr::io
