// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/memory.hpp"

#include <sys/mman.h>

#include <cstdint>

namespace pamr {

namespace {

constexpr std::uintptr_t large_page = std::uintptr_t{2} << 20U;
constexpr std::uintptr_t small_page = std::uintptr_t{4} << 10U;
constexpr int collapse = 25;  // MADV_COLLAPSE of Linux 6.1, which older headers lack

}  // namespace

void advise_large_pages(void* memory, std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  if (bytes < large_page) return;
  // from the page on that holds the allocator's own words; the system looks for whole large pages by itself
  const auto begin = reinterpret_cast<std::uintptr_t>(memory) & ~(small_page - 1);
  const auto end = (reinterpret_cast<std::uintptr_t>(memory) + bytes + small_page - 1) & ~(small_page - 1);
  // advice only: where it is refused, small pages serve
  auto* const pages = static_cast<char*>(memory) - (reinterpret_cast<std::uintptr_t>(memory) - begin);
  (void)madvise(pages, end - begin, MADV_HUGEPAGE);
  // the allocator has written to the first page already, so that its large page does not come by itself
  if (begin % large_page == 0) (void)madvise(pages, large_page, collapse);
#else
  (void)memory;
  (void)bytes;
#endif
}

std::size_t fill_large_pages(std::size_t bytes) {
  constexpr std::size_t of_allocator = 64;
  if (bytes < 4 * large_page) return bytes;
  return (bytes + of_allocator + large_page - 1) / large_page * large_page - of_allocator;
}

}  // namespace pamr
