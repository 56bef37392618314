// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <csignal>

namespace pamr::dsmc {

/// While it lives, SIGTERM, SIGINT, SIGHUP and SIGUSR1 only ask for the end of the run; one that the process ignores
/// (nohup) stays ignored. At most one at a time.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();  ///< the signals do again what they did before
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  StopSignals(StopSignals&&) = delete;
  StopSignals& operator=(StopSignals&&) = delete;

  /// True once one of them has reached this process. Local.
  static bool have_come();

 private:
  static constexpr std::array signals{SIGTERM, SIGINT, SIGHUP, SIGUSR1};
  std::array<struct sigaction, signals.size()> before_{};
};

}  // namespace pamr::dsmc
