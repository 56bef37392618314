// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace pamr::dsmc {

constexpr std::size_t max_few = 48;  ///< up to so many, `rank_few` is faster than sorting

/// Where each of up to `max_few` numbers comes when they are sorted, equal ones in the order in which they are given.
/// Compares each with all, several at a time: more comparisons than sorting needs, but no branch that cannot be
/// foretold. Values of `rank` behind those of the numbers mean nothing. O(numbers^2). Local.
void rank_few(std::span<const std::uint64_t> numbers, std::array<std::uint32_t, max_few>& rank);

}  // namespace pamr::dsmc
