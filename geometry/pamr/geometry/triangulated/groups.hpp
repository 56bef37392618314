// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace pamr::geometry {

/// Sets of numbers that grow together.
class Groups {
 public:
  explicit Groups(std::size_t n);
  /// The number that stands for the set of `i`.
  int of(int i);
  void join(int a, int b);

 private:
  std::vector<int> parent_;
};

}  // namespace pamr::geometry
