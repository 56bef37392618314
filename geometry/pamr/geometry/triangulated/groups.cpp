// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/groups.hpp"

#include <algorithm>
#include <numeric>

#include "pamr/base/index.hpp"

namespace pamr::geometry {

Groups::Groups(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

int Groups::of(int i) {
  while (parent_[at(i)] != i) {
    parent_[at(i)] = parent_[at(parent_[at(i)])];
    i = parent_[at(i)];
  }
  return i;
}

void Groups::join(int a, int b) {
  a = of(a);
  b = of(b);
  parent_[at(std::max(a, b))] = std::min(a, b);
}

}  // namespace pamr::geometry
