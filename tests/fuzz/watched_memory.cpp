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

void note(std::size_t bytes) {
  if (largest == nullptr) return;
  auto seen = largest->load();
  while (seen < bytes && !largest->compare_exchange_weak(seen, bytes)) {
  }
}

}  // namespace

extern "C" {
void* malloc(std::size_t bytes) {
  note(bytes);
  return __libc_malloc(bytes);
}
void* calloc(std::size_t n, std::size_t bytes) {
  std::size_t product = 0;
  note(__builtin_mul_overflow(n, bytes, &product) ? static_cast<std::size_t>(-1) : product);
  return __libc_calloc(n, bytes);
}
void* realloc(void* old, std::size_t bytes) {
  note(bytes);
  return __libc_realloc(old, bytes);
}
}

namespace pamr::fuzz {

void watch_memory() {
  void* page = mmap(nullptr, sizeof *largest, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (page == MAP_FAILED) throw std::bad_alloc();
  largest = new (page) std::atomic<std::size_t>(0);
}

std::size_t largest_request() { return largest->exchange(0); }

}  // namespace pamr::fuzz
