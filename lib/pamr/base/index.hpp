// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <concepts>
#include <cstddef>

#include "pamr/base/exact.hpp"

namespace pamr {

/// The id `i` as an array index: `cell_to_node[at(cell)]`. Only the type changes (ids are signed, containers count
/// with `std::size_t`); nothing is looked up and no bound is checked. Pre: `i >= 0`.
constexpr std::size_t at(std::integral auto i) { return static_cast<std::size_t>(i); }
template <class T>
constexpr std::size_t at(Exact<T> i) {
  return static_cast<std::size_t>(T{i});
}

}  // namespace pamr
