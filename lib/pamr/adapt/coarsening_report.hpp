// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "pamr/coarsen/settle_octets.hpp"

namespace pamr::adapt {

/// Coarsening statistics: octets removed, and why the rest stayed; counts over all ranks. An octet is eight cells of
/// one regular split, each of which may be replaced by a closure family.
struct CoarseningReport : coarsen::Outcome {
  std::int64_t cells_flagged = 0;           ///< cells with a flag below 0
  std::int64_t cells_without_parent = 0;    ///< of them: level 0, broken families, cells of files of format 1
  std::int64_t cells_without_siblings = 0;  ///< of them: of an octet of which some cell is not flagged, or was split
  std::int64_t cells_moved = 0;             ///< to the rank of their siblings
  std::int64_t cells_between = 0;           ///< cells after coarsening, before anything was split
};

}  // namespace pamr::adapt
