// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/resource.h>
#include <sys/types.h>

#include <functional>
#include <span>
#include <string>

namespace pamr::io {

/// A forked process that does something which may kill it and sends bytes back. HDF5 1.10 crashes or runs for ever on
/// some damaged files, so whatever looks at unverified structure runs in here.
///
/// `produce` may use HDF5's serial driver and plain system calls, but neither MPI nor anything that other threads of
/// this process may hold. It runs under limits on processor time and memory, with standard streams and signal handlers
/// reset; no exit handler runs at its end.
class Isolated {
 public:
  using Send = std::function<void(std::span<const char> bytes)>;
  struct Limits {
    rlim_t processor_seconds = 2;
    rlim_t memory_bytes = 0;  ///< beyond what this process has
  };

  /// Forks. Throws `Error` when the system has no process or pipe left. Local.
  Isolated(const std::function<void(const Send&)>& produce, Limits limits);
  /// Ends the process if it still runs.
  ~Isolated();
  Isolated(const Isolated&) = delete;
  Isolated& operator=(const Isolated&) = delete;
  Isolated(Isolated&&) = delete;
  Isolated& operator=(Isolated&&) = delete;

  /// Waits for so many bytes; false when the process ended or stood still before.
  bool receive(std::span<char> to);
  /// Everything that it sends.
  std::string receive_all();
  /// Waits for its end: empty when that was a good one, otherwise what happened.
  std::string end();

 private:
  /// One read; 0 at the end or after two minutes without a sign of life.
  std::size_t receive_some(std::span<char> to);
  void stop() noexcept;

  pid_t child_ = -1;
  int pipe_end_ = -1;
  int status_ = 0;
  bool stood_still_ = false;
};

}  // namespace pamr::io
