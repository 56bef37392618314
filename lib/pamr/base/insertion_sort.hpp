// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

namespace pamr {

/// Puts a short list in order: `less(a, b)` says that `a` comes before `b`; equal items keep their order. Faster than
/// `std::sort` for a handful of items, which is what it is for: the cost grows with the square of their number.
template <class Item, class Less>
void insertion_sort(std::span<Item> items, Less less) {
  for (std::size_t i = 1; i < items.size(); ++i) {
    const auto item = items[i];
    auto k = i;
    for (; k > 0 && less(item, items[k - 1]); --k) items[k] = items[k - 1];
    items[k] = item;
  }
}

}  // namespace pamr
