// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::par {

/// Words compared from the first to the last: a value, what breaks its ties, and what breaks those.
using SortKey = std::array<std::uint64_t, 5>;

/// Bits of a double that compare as unsigned integers just as the doubles do; -0 equals +0.
inline std::uint64_t ordered_bits(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value + 0.0);
  constexpr std::uint64_t sign = std::uint64_t{1} << 63U;
  return (bits & sign) != 0 ? ~bits : bits | sign;
}

/// Chooses the `count` smallest keys of all ranks together: `result[i]` is 1 when `key[i]` is one of them. Among equal
/// keys that do not all fit, those on lower ranks and then with lower `i` are taken, so keys should be unique.
/// Collective: at most 41 reductions of 256 integers; nothing is sorted and no key leaves its rank.
std::vector<std::uint8_t> select_smallest(const Comm& comm, std::span<const SortKey> key, Exact<std::int64_t> count);

}  // namespace pamr::par
