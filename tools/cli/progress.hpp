// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace pamr::cli {

/// A long piece of work in units that are counted.
struct Work {
  std::string what, unit;
  std::int64_t total = 0;   ///< units; below zero: not known
  std::int64_t before = 0;  ///< units that were complete already, which say nothing of the rate
};

/// Shows how far a long piece of work has come, on standard error: on a terminal a bar with rate and time left that is
/// redrawn at most ten times a second, elsewhere a plain line every ten seconds. Work that is over sooner shows
/// nothing there. Local; cheap enough for every step of a loop.
class Progress {
 public:
  /// See `Work`.
  Progress(std::string what, std::int64_t total, std::string unit, bool shown, std::int64_t before = 0);
  /// Takes the bar off the terminal.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  Progress(Progress&&) = delete;
  Progress& operator=(Progress&&) = delete;

  /// `done` of `total` units are complete; `step` names what is under way.
  void update(std::int64_t done, const std::string& step = {});

 private:
  using Clock = std::chrono::steady_clock;

  Work work_;
  bool shown_;
  bool on_terminal_;
  bool drawn_ = false;
  Clock::time_point start_;
  Clock::time_point last_;
};

/// The text of one line: "refining: 40 of 100 cells (40 %), 12.5 cells/s, 0:05 left, close"; with an unknown total
/// "refining: 40 cells, 12.5 cells/s, close".
std::string progress_text(const Work& work, std::int64_t done, double seconds, const std::string& step = {});

}  // namespace pamr::cli
