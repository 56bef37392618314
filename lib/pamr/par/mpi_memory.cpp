// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/mpi_memory.hpp"

#include <sys/mman.h>

#include <cstddef>

namespace pamr::par {

bool has_mpi_memory(int n_ranks) {
  if (n_ranks == 1) return true;
  // Open MPI maps 4 MB for each neighbor on the machine, and less than 2 MB with the components that open a file.
  constexpr std::size_t enough = std::size_t{32} << 20U;
  void* const memory = mmap(nullptr, enough, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return false;
  munmap(memory, enough);
  return true;
}

}  // namespace pamr::par
