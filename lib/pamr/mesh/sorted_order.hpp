// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::mesh {

/// Indices of the keys in ascending order, equal keys in the order in which they stand. At most 2^32 keys. Local.
/// Cost: for keys that differ in their 32 leading bits O(n) time (radix sort), O(n log n) at worst; 16 bytes a key of
/// memory besides the result.
std::vector<std::uint32_t> sorted_order(std::span<const std::uint64_t> key);

/// The same where the key says only the beginning: indices of equal keys are put in order by `less(i, k)`.
template <class Less>
std::vector<std::uint32_t> sorted_order(std::span<const std::uint64_t> key, Less less) {
  auto order = sorted_order(key);
  for (auto begin = order.begin(), end = begin; begin != order.end(); begin = end) {
    while (end != order.end() && key[*end] == key[*begin]) ++end;
    if (end - begin > 1) std::sort(begin, end, less);
  }
  return order;
}

/// Indices of the faces on the rank border by the rank on their other side, then by their nodes. Local.
std::vector<std::uint32_t> border_order(std::span<const Rank> rank, std::span<const par::SharedKey> key);

}  // namespace pamr::mesh
