// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace pamr {

/// Indices of the keys in ascending order, equal keys in the order in which they stand. At most 2^32 keys. Local.
/// Cost: for keys that differ in their 32 leading bits O(n) time (radix sort), O(n log n) at worst; 16 bytes a key of
/// memory in addition to the result.
std::vector<std::uint32_t> sorted_order(std::span<const std::uint64_t> key);

}  // namespace pamr
