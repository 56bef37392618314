// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pamr {

/// Has the cache line of `address` fetched while other work goes on. The empty statement is for functions that do
/// nothing but this: GCC takes `__builtin_prefetch` alone for no effect and leaves calls of such functions out.
inline void prefetch(const void* address) {
  __builtin_prefetch(address);
  asm volatile("");
}

}  // namespace pamr
