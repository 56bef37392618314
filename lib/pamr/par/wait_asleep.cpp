// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/wait_asleep.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

namespace pamr::par {

std::optional<int> wait_asleep(MPI_Request& request, double seconds) {
  const auto begin = std::chrono::steady_clock::now();
  for (;;) {
    int is_done = 0;
    const int code = MPI_Test(&request, &is_done, MPI_STATUS_IGNORE);
    if (is_done != 0 || code != MPI_SUCCESS) return code;
    const std::chrono::nanoseconds waited = std::chrono::steady_clock::now() - begin;
    if (std::chrono::duration<double>(waited).count() > seconds) return std::nullopt;
    if (waited < std::chrono::microseconds(50)) continue;  // most have come by then
    std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(waited / 4, std::chrono::milliseconds(1)));
  }
}

}  // namespace pamr::par
