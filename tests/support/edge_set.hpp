// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstddef>
#include <initializer_list>
#include <iterator>

namespace pamr::test {

/// A set of the six edges of a cell, with the names of `std::set<int>`; the reference makes millions of them.
class EdgeSet {
 public:
  /// Edges in ascending order.
  class Iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = int;
    using difference_type = std::ptrdiff_t;
    using pointer = const int*;
    using reference = int;

    Iterator() = default;
    explicit Iterator(unsigned rest) : rest_(rest) {}
    int operator*() const { return std::countr_zero(rest_); }
    Iterator& operator++() {
      rest_ &= rest_ - 1;
      return *this;
    }
    Iterator operator++(int) {
      const auto before = *this;
      ++*this;
      return before;
    }
    bool operator==(const Iterator&) const = default;

   private:
    unsigned rest_ = 0;
  };

  EdgeSet() = default;
  EdgeSet(std::initializer_list<int> edges) {
    for (const int e : edges) insert(e);
  }

  Iterator begin() const { return Iterator(bits_); }
  static Iterator end() { return {}; }
  std::size_t size() const { return static_cast<std::size_t>(std::popcount(bits_)); }
  bool empty() const { return bits_ == 0; }
  std::size_t count(int edge) const { return bits_ >> edge & 1; }

  void insert(int edge) { bits_ |= 1U << edge; }
  void erase(int edge) { bits_ &= ~(1U << edge); }
  void merge(EdgeSet other) { bits_ |= other.bits_; }

  bool operator==(const EdgeSet&) const = default;
  bool operator<(const EdgeSet& other) const { return bits_ < other.bits_; }

 private:
  unsigned bits_ = 0;
};

inline EdgeSet common(EdgeSet a, EdgeSet b) {
  EdgeSet both;
  for (const int e : a)
    if (b.count(e) != 0) both.insert(e);
  return both;
}

}  // namespace pamr::test
