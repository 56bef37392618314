// SPDX-License-Identifier: GPL-3.0-or-later
// Counts what a program takes from C++'s heap, to be loaded before it (LD_PRELOAD): the memory of our own arrays
// without that of MPI, HDF5 and Scotch, which are written in C. At the end of the process a line goes into the file
// that PAMR_OWN_MEMORY names: the most bytes that were taken at once, then kB of pages that belong to it alone, that
// come from files and that are shared.
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {

std::atomic<long> now{0}, most{0};

void* count(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  const auto sum = now += static_cast<long>(malloc_usable_size(memory));
  for (auto before = most.load(); sum > before && !most.compare_exchange_weak(before, sum);) {
  }
  return memory;
}

void release(void* memory) {
  if (memory == nullptr) return;
  now -= static_cast<long>(malloc_usable_size(memory));
  std::free(memory);
}

long kilobytes(const char* status, const char* key) {
  const auto* found = std::strstr(status, key);
  return found == nullptr ? -1 : std::strtol(found + std::strlen(key), nullptr, 10);
}

struct AtEnd {
  ~AtEnd() {
    const auto* name = std::getenv("PAMR_OWN_MEMORY");
    auto* status = std::fopen("/proc/self/status", "r");
    if (name == nullptr || status == nullptr || std::getenv("OMPI_COMM_WORLD_RANK") == nullptr) return;
    std::array<char, 8192> text{};
    (void)!std::fread(text.data(), 1, text.size() - 1, status);
    std::fclose(status);
    if (auto* file = std::fopen(name, "a"); file != nullptr) {
      std::fprintf(file, "%ld %ld %ld %ld %ld\n", most.load(), kilobytes(text.data(), "RssAnon:"),
                   kilobytes(text.data(), "RssFile:"), kilobytes(text.data(), "RssShmem:"),
                   kilobytes(text.data(), "VmHWM:"));
      std::fclose(file);
    }
  }
} at_end;

}  // namespace

void* operator new(std::size_t n) { return count(std::malloc(std::max<std::size_t>(n, 1))); }
void* operator new[](std::size_t n) { return operator new(n); }
void* operator new(std::size_t n, std::align_val_t a) {
  const auto align = static_cast<std::size_t>(a);
  return count(std::aligned_alloc(align, (std::max<std::size_t>(n, 1) + align - 1) / align * align));
}
void* operator new[](std::size_t n, std::align_val_t a) { return operator new(n, a); }
void operator delete(void* memory) noexcept { release(memory); }
void operator delete[](void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }
