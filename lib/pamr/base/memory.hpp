// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace pamr {

/// Tells the system that this memory, not yet touched, will be used as a whole, so that it may be given in large pages:
/// first touch and scattered reading then cost far fewer page faults and translations. Only the whole large pages
/// inside are named, so never more memory is taken than was asked for. Does nothing for short ranges and where the
/// system knows no large pages; never fails.
void advise_large_pages(void* memory, std::size_t bytes);

/// Reserves room for `n` items in an empty vector, in large pages where that pays. Every array that grows with the
/// mesh and lives through a refinement is made so.
template <class T>
void reserve_array(std::vector<T>& array, std::size_t n) {
  if (array.capacity() >= n) return;
  array.reserve(n);
  advise_large_pages(array.data(), array.capacity() * sizeof(T));
}

/// `n` items of that value in large pages where that pays.
template <class T>
void assign_array(std::vector<T>& array, std::size_t n, const T& value) {
  array.clear();
  reserve_array(array, n);
  array.assign(n, value);
}

}  // namespace pamr
