// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/timer.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <ctime>

namespace pamr {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::size_t peak_resident_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

StepTimer::StepTimer() : last_wall_(wall_seconds()), last_cpu_(cpu_seconds()) {}

void StepTimer::lap(const std::string& step) {
  auto entry = std::find_if(steps_.begin(), steps_.end(), [&](const StepTime& s) { return s.step == step; });
  if (entry == steps_.end()) entry = steps_.insert(steps_.end(), StepTime{step, 0, 0});
  const double wall = wall_seconds(), cpu = cpu_seconds();
  entry->wall += wall - last_wall_;
  entry->cpu += cpu - last_cpu_;
  last_wall_ = wall;
  last_cpu_ = cpu;
}

}  // namespace pamr
