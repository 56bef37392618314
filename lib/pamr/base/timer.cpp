// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/timer.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <utility>

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

Traffic& Traffic::operator+=(const Traffic& other) {
  messages += other.messages;
  bytes += other.bytes;
  bytes_received += other.bytes_received;
  rounds += other.rounds;
  reductions += other.reductions;
  wait_wall += other.wait_wall;
  wait_cpu += other.wait_cpu;
  external_cpu += other.external_cpu;
  return *this;
}

Traffic& Traffic::operator-=(const Traffic& other) {
  messages -= other.messages;
  bytes -= other.bytes;
  bytes_received -= other.bytes_received;
  rounds -= other.rounds;
  reductions -= other.reductions;
  wait_wall -= other.wait_wall;
  wait_cpu -= other.wait_cpu;
  external_cpu -= other.external_cpu;
  return *this;
}

StepTimer::StepTimer(std::function<Traffic()> traffic) : traffic_(std::move(traffic)) { skip(); }

namespace {

StepTime& step_named(std::vector<StepTime>& steps, const std::string& name) {
  auto entry = std::find_if(steps.begin(), steps.end(), [&](const StepTime& s) { return s.step == name; });
  if (entry == steps.end()) entry = steps.insert(steps.end(), StepTime{name});
  return *entry;
}

}  // namespace

void StepTimer::lap(const std::string& step) {
  auto& entry = step_named(steps_, step);
  entry.wall -= last_wall_;
  entry.cpu -= last_cpu_;
  entry.traffic -= last_traffic_;
  skip();
  entry.wall += last_wall_;
  entry.cpu += last_cpu_;
  entry.traffic += last_traffic_;
}

void StepTimer::skip() {
  last_wall_ = wall_seconds();
  last_cpu_ = cpu_seconds();
  if (traffic_) last_traffic_ = traffic_();
}

std::vector<StepTime> merge_steps(std::vector<StepTime> first, const std::vector<StepTime>& second) {
  for (const auto& step : second) {
    auto& entry = step_named(first, step.step);
    entry.wall += step.wall;
    entry.cpu += step.cpu;
    entry.traffic += step.traffic;
  }
  return first;
}

}  // namespace pamr
