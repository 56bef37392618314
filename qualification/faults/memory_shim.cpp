// SPDX-License-Identifier: GPL-3.0-or-later
// Loaded before a tool (LD_PRELOAD), it has one request for memory fail: FAULT=no-memory:R:N is the N-th of rank R,
// counted from 1. With N = 0 none fails, and their number is written to the file FAULT_COUNT when the process ends.
// Only what C++ asks for by `operator new` counts, which is what the tool itself wants: libraries in C have their own
// ways.
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <new>

namespace {

std::atomic<long> requests{0};

/// The request that fails, -1 where none is to fail.
long failing_request() {
  const char* fault = std::getenv("FAULT");
  const char* rank = std::getenv("OMPI_COMM_WORLD_RANK");
  long victim = 0, request = 0;
  if (fault == nullptr || std::sscanf(fault, "no-memory:%ld:%ld", &victim, &request) != 2) return -1;
  return victim == (rank != nullptr ? std::atol(rank) : 0) ? request : -1;
}

/// Memory that is found by `allocate`, if this request is not the one that fails.
template <class Allocate>
void* request(Allocate allocate) {
  static const long failing = failing_request();
  void* memory = ++requests == failing ? nullptr : allocate();
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

struct CountAtEnd {
  ~CountAtEnd() {
    const char* name = std::getenv("FAULT_COUNT");
    if (name == nullptr || failing_request() != 0) return;
    if (std::FILE* file = std::fopen(name, "w")) {
      std::fprintf(file, "%ld\n", requests.load());
      std::fclose(file);
    }
  }
} count_at_end;

}  // namespace

void* operator new(std::size_t size) {
  return request([=] { return std::malloc(size > 0 ? size : 1); });
}

void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto step = static_cast<std::size_t>(alignment);
  return request([=] { return std::aligned_alloc(step, (size + step) / step * step); });
}

void operator delete(void* memory) noexcept { std::free(memory); }

void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }

void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
