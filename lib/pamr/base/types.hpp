// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>

namespace pamr {

/// Index of a node or cell on this rank, 0-based.
using LocalId = std::int32_t;
/// Number of a node or cell in the whole mesh, 0-based, the same on every rank.
using GlobalId = std::int64_t;
/// Number of a process in its communicator.
using Rank = int;

inline constexpr LocalId invalid_local = std::numeric_limits<LocalId>::min();
inline constexpr GlobalId invalid_global = std::numeric_limits<GlobalId>::min();

}  // namespace pamr
