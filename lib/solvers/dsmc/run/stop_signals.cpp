// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/stop_signals.hpp"

namespace pamr::dsmc {

namespace {

volatile std::sig_atomic_t signal_came = 0;  // a handler can reach nothing but a global

}  // namespace

StopSignals::StopSignals() {
  signal_came = 0;
  struct sigaction action {};
  action.sa_handler = [](int) { signal_came = 1; };
  action.sa_flags = SA_RESTART;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    ::sigaction(signals[i], nullptr, &before_[i]);
    if (before_[i].sa_handler != SIG_IGN) ::sigaction(signals[i], &action, nullptr);
  }
}

StopSignals::~StopSignals() {
  for (std::size_t i = 0; i < signals.size(); ++i) ::sigaction(signals[i], &before_[i], nullptr);
}

bool StopSignals::have_come() { return signal_came != 0; }

}  // namespace pamr::dsmc
