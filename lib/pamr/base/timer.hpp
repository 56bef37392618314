// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace pamr {

/// Seconds since some fixed moment, by the wall clock.
double wall_seconds();
/// Seconds of processor time that this process has used.
double cpu_seconds();
/// Largest memory that this process has held so far, bytes.
std::size_t peak_resident_bytes();

/// What a process has sent to others since some moment, and what it has spent inside the calls that do so: waiting for
/// the others, polling, and copying to and from the network. The rest of its processor time is its own work.
struct Traffic {
  std::int64_t messages = 0;        ///< to single other ranks
  std::int64_t bytes = 0;           ///< sent in them
  std::int64_t bytes_received = 0;  ///< by messages from single other ranks
  std::int64_t rounds = 0;          ///< exchanges of messages, whether this rank had anything to say in them or not
  std::int64_t reductions = 0;  ///< operations of all ranks together: reductions, scans, gathers, broadcasts, barriers
  double wait_wall = 0;         ///< seconds
  double wait_cpu = 0;          ///< seconds
  double external_cpu = 0;      ///< seconds; the part of it within libraries that communicate by themselves

  Traffic& operator+=(const Traffic& other);
  Traffic& operator-=(const Traffic& other);
  friend Traffic operator-(Traffic a, const Traffic& b) { return a -= b; }
};

/// What one step of a pipeline took on this rank.
struct StepTime {
  std::string step;
  double wall = 0;       ///< seconds
  double cpu = 0;        ///< seconds
  Traffic traffic = {};  ///< part of it

  /// Seconds of processor time outside of communication.
  double compute() const { return cpu - traffic.wait_cpu; }
};

/// Cuts the time of a pipeline into named steps without gaps: each `lap` books the time since the last one. Steps of
/// the same name add up; steps stay in the order in which they were first named.
class StepTimer {
 public:
  /// `traffic` tells what this process has communicated so far (`[&] { return comm.traffic(); }`); empty: nothing.
  explicit StepTimer(std::function<Traffic()> traffic = {});
  void lap(const std::string& step);
  /// Leaves out the time since the last lap: something else has booked it.
  void skip();
  const std::vector<StepTime>& steps() const { return steps_; }

 private:
  std::function<Traffic()> traffic_;
  double last_wall_ = 0;
  double last_cpu_ = 0;
  Traffic last_traffic_;
  std::vector<StepTime> steps_;
};

/// Two lists of steps as one, in the order of the first, then of the second; equal names add up.
std::vector<StepTime> merge_steps(std::vector<StepTime> first, const std::vector<StepTime>& second);

}  // namespace pamr
