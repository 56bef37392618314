// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pamr {

/// Seconds since some fixed moment, by the wall clock.
double wall_seconds();
/// Seconds of processor time that this process has used.
double cpu_seconds();
/// Largest memory that this process has held so far, bytes.
std::size_t peak_resident_bytes();

/// What one step of a pipeline took on this rank.
struct StepTime {
  std::string step;
  double wall = 0;  ///< seconds
  double cpu = 0;   ///< seconds
};

/// Cuts the time of a pipeline into named steps without gaps: each `lap` books the time since the last one. Steps of
/// the same name add up; steps stay in the order in which they were first named.
class StepTimer {
 public:
  StepTimer();
  void lap(const std::string& step);
  /// Leaves out the time since the last lap: something else has booked it.
  void skip();
  const std::vector<StepTime>& steps() const { return steps_; }

 private:
  double last_wall_;
  double last_cpu_;
  std::vector<StepTime> steps_;
};

/// Two lists of steps as one, in the order of the first, then of the second; equal names add up.
std::vector<StepTime> merge_steps(std::vector<StepTime> first, const std::vector<StepTime>& second);

}  // namespace pamr
