// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>

#include "pamr/base/exact.hpp"

namespace pamr {

/// Index of a node or cell on this rank, 0-based.
using LocalId = std::int32_t;
/// Number of a node or cell in the whole mesh, the same on every rank; 0-based where nothing else is said (`IdRange`).
using GlobalId = std::int64_t;
/// Number of a process in its communicator.
using Rank = int;

/// All nodes or all cells of a mesh by number: `n` of them from `first` on. A plain count stands for numbers from 0 on.
struct IdRange {
  constexpr IdRange(GlobalId count, Exact<GlobalId> first_id = 0) : n(count), first(first_id) {}
  template <Narrows<GlobalId> T>
  IdRange(T count, GlobalId first_id = 0) = delete;

  constexpr GlobalId end() const { return first + n; }
  constexpr bool contains(GlobalId id) const { return id >= first && id < end(); }

  GlobalId n;
  GlobalId first;
};

inline constexpr LocalId invalid_local = std::numeric_limits<LocalId>::min();
inline constexpr GlobalId invalid_global = std::numeric_limits<GlobalId>::min();

}  // namespace pamr
