// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mpi.h>

#include <limits>
#include <optional>

namespace pamr::par {

/// Waits for a request of which others may be long in coming, and sleeps meanwhile, a quarter of the time that it has
/// waited and a millisecond at most at a time: the processor is left to those that work. MPI's code; nothing when so
/// many seconds have passed before. Local.
std::optional<int> wait_asleep(MPI_Request& request, double seconds = std::numeric_limits<double>::infinity());

}  // namespace pamr::par
