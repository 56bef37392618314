// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/sum_modulo.hpp"

#include <array>

namespace pamr::par {

std::uint64_t sum_modulo(const Comm& comm, Exact<std::uint64_t> here) {
  // in halves, so that no signed sum overflows
  std::array<std::int64_t, 2> half{static_cast<std::int64_t>(here & 0xffffffffU),
                                   static_cast<std::int64_t>(here >> 32U)};
  comm.sum_in_place(half);
  return static_cast<std::uint64_t>(half[0]) + (static_cast<std::uint64_t>(half[1]) << 32U);
}

}  // namespace pamr::par
