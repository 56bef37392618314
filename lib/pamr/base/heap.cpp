// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/heap.hpp"

#include <cstddef>
#include <cstdlib>

#ifdef __GLIBC__
#include <malloc.h>
#include <unistd.h>
#endif

#include "pamr/base/memory.hpp"

namespace pamr {

void set_up_heap() {
#ifdef __GLIBC__
  constexpr int megabyte = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, megabyte);
  mallopt(M_TRIM_THRESHOLD, 256 * megabyte);
  mallopt(M_TOP_PAD, 64 * megabyte);
  auto* const begin = static_cast<std::byte*>(sbrk(0));
  void* volatile more_than_is_there = std::malloc(megabyte - 4096);
  std::free(more_than_is_there);
  advise_large_pages(begin, static_cast<std::size_t>(static_cast<std::byte*>(sbrk(0)) - begin));
#endif
}

}  // namespace pamr
