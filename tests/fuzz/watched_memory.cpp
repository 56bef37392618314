// SPDX-License-Identifier: GPL-3.0-or-later
#include "watched_memory.hpp"

#include <sys/mman.h>

#include <atomic>
#include <new>

extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t n, std::size_t bytes);
void* __libc_realloc(void* old, std::size_t bytes);
}

namespace {

/// Shared between the processes; null until watching starts.
std::atomic<std::size_t>* largest = nullptr;

/// Only memory that was given counts: the reader's child process asks under a limit, and is refused.
[[maybe_unused]] void* note(void* given, std::size_t bytes) {
  if (largest == nullptr || given == nullptr) return given;
  auto seen = largest->load();
  while (seen < bytes && !largest->compare_exchange_weak(seen, bytes)) {
  }
  return given;
}

}  // namespace

// The address sanitizer has a malloc of its own; under it memory is not watched.
#ifndef __SANITIZE_ADDRESS__
extern "C" {
void* malloc(std::size_t bytes) { return note(__libc_malloc(bytes), bytes); }
void* calloc(std::size_t n, std::size_t bytes) { return note(__libc_calloc(n, bytes), n * bytes); }
void* realloc(void* old, std::size_t bytes) { return note(__libc_realloc(old, bytes), bytes); }
}
#endif

namespace pamr::fuzz {

void watch_memory() {
  void* page = mmap(nullptr, sizeof *largest, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (page == MAP_FAILED) throw std::bad_alloc();
  largest = new (page) std::atomic<std::size_t>(0);
}

std::size_t largest_piece() { return largest->exchange(0); }

}  // namespace pamr::fuzz
