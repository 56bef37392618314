// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace pamr::bench {

/// What this process has done in MPI so far. A program that links mpi_counts.cpp stands between MPI and all that calls
/// it, libraries like PETSc and hypre included: every call is timed and counted.
struct MpiCounts {
  double cpu = 0;  ///< seconds inside of MPI: waiting, polling, copying
  std::int64_t messages = 0, bytes = 0, reductions = 0;
};
const MpiCounts& mpi_counts();

}  // namespace pamr::bench
