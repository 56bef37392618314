// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace pamr {

/// Tells the system that this memory, not yet touched, will be used as a whole, so that it may be given in large pages:
/// first touch and scattered reading then cost far fewer page faults and translations. Does nothing for short ranges
/// and where the system knows no large pages; never fails.
void advise_large_pages(void* memory, std::size_t bytes);

/// Bytes to ask for where `bytes` are needed: a little more, so that a long array and what the allocator keeps beside
/// it are whole large pages, which Linux from 6.7 on then aligns. Otherwise an array begins and ends in the midst of
/// one: 2 MB of small pages, a fault each. Short arrays, of which that would be more than a quarter, stay as they are.
std::size_t fill_large_pages(std::size_t bytes);

/// Reserves room for `n` items in an empty vector, in large pages where that pays. Every array that grows with the
/// mesh is made so. Room that is never written takes address space, but no memory.
template <class T>
void reserve_array(std::vector<T>& array, std::size_t n) {
  if (array.capacity() >= n) return;
  array.reserve(fill_large_pages(n * sizeof(T)) / sizeof(T));
  advise_large_pages(array.data(), array.capacity() * sizeof(T));
}

/// Gives the memory of an array back. (`array = {}` would keep its room: it assigns a list of no items.)
template <class T>
void free_array(std::vector<T>& array) {
  std::vector<T>().swap(array);
}

/// A copy with room for `n` items.
template <class T>
std::vector<T> copy_array(const std::vector<T>& array, std::size_t n) {
  std::vector<T> copy;
  reserve_array(copy, n);
  copy.assign(array.begin(), array.end());
  return copy;
}

/// Room for `n` items in a vector that keeps what it holds.
template <class T>
void grow_array(std::vector<T>& array, std::size_t n) {
  if (array.capacity() < n) array = copy_array(array, n);
}

/// `n` items of that value in large pages where that pays.
template <class T>
void assign_array(std::vector<T>& array, std::size_t n, const T& value) {
  array.clear();
  reserve_array(array, n);
  array.assign(n, value);
}

}  // namespace pamr
