// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <malloc.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <string>

/// The memory of a process that is measured.
namespace peer {

/// A value of the system's, bytes.
inline long status_bytes(const std::string& key, const char* file = "/proc/self/status") {
  std::ifstream status(file);
  for (std::string word; status >> word;)
    if (word == key) {
      status >> word;
      return 1024 * std::stol(word);
    }
  return 0;
}

/// Forgets the peak so far where the system allows it: `VmHWM:` is of what comes next.
inline void restart_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

/// Gives back what is free too, so that the peak to come is that of the call.
inline void forget_peak() {
  malloc_trim(0);
  restart_peak();
}

/// Takes memory in large pages, at most half of what is free, and gives it back: what a virtual machine has lent to its
/// host comes back before a run, not in it (docs/reports/performance.md, "Runs that differ"). As warm_memory.py.
inline void warm_memory(std::size_t bytes) {
  constexpr std::size_t large_page = std::size_t{1} << 21U, page = 4096;
  if (bytes < 32 * large_page) return;  // what an allocator keeps to itself, and caches hold
  const auto size = std::min(bytes, static_cast<std::size_t>(status_bytes("MemAvailable:", "/proc/meminfo")) / 2);
  void* const memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return;
  madvise(memory, size, MADV_HUGEPAGE);
  for (std::size_t at = 0; at < size; at += page) static_cast<volatile char*>(memory)[at] = 1;
  munmap(memory, size);
}

}  // namespace peer
