// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/runtime.hpp"

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "pamr/par/lone_start.hpp"
#include "pamr/par/mpi_memory.hpp"
#include "pamr/par/parent_job.hpp"
#include "pamr/par/wait_asleep.hpp"

namespace pamr::par {

namespace {

constexpr int out_of_memory = 3;  // exit code, as of the tools

}  // namespace

Runtime::Runtime(int& argc, char**& argv) {
  leave_parent_job();
  // hwloc, which Open MPI asks for the machine's cores, asks an X server for graphics cards; an X server that ends then
  // ends the process.
  setenv("HWLOC_COMPONENTS", "-gl", 0);
  // Errors of these calls end the program: MPI's own error handler is in force until a `Comm` replaces it.
  {
    const LoneStart alone;
    MPI_Init(&argc, &argv);
  }
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  if (!has_mpi_memory(size_)) {
    std::fprintf(stderr, "%s: error: out of memory\n", program_invocation_short_name);
    abort(out_of_memory);
  }
  MPI_Comm_dup(MPI_COMM_WORLD, &end_);
}

Runtime::~Runtime() {
  MPI_Comm_free(&end_);
  MPI_Finalize();
}

std::optional<Runtime::Outcome> Runtime::settle(int code, double seconds) const {
  // The greatest code first, then the lowest rank, in one number.
  constexpr std::int64_t ranks = std::int64_t{1} << 32U;
  const std::int64_t here = std::int64_t{code} * ranks + (ranks - 1 - rank_);
  std::int64_t greatest = 0;
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Iallreduce(&here, &greatest, 1, MPI_INT64_T, MPI_MAX, end_, &request);
  if (!wait_asleep(request, seconds)) return std::nullopt;
  return Outcome{static_cast<int>(greatest / ranks), static_cast<Rank>(ranks - 1 - greatest % ranks)};
}

void Runtime::abort(int code) const {
  std::fflush(nullptr);
  if (size_ > 1) MPI_Abort(MPI_COMM_WORLD, code);
  std::_Exit(code);  // alone: without the notice that MPI_Abort prints
}

}  // namespace pamr::par
