// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/resource.h>
#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace pamr {

// Why there is a process of its own for files
//
// Threat: a damaged file (a flipped byte, a broken copy, a bad disk) makes HDF5 1.10 crash, run for ever or ask for all
// the memory of the machine, in the library itself, before any check of ours sees a value. On 1,000 ranks that is a
// dead job without a message; with a process of its own it is an error that names the file, the same on every rank.
//
// CAD files are the same case: OpenCASCADE may crash on a damaged STEP text (geometry/cad/cad_source.hpp).
//
// What else runs in it: reading the structure of a file (once, on rank 0), and reading compressed or chunked datasets
// (on each rank that reads rows of one; files that this library writes have none). Everything else is read by the ranks
// themselves, from places in the file that were verified.
//
// Limits: this is a guard against damage, not against attack: the process has the rights of its parent.
//
// Where it is forbidden: some sites and some MPI transports do not allow a process to fork after MPI_Init. The
// environment variable PAMR_NO_FORK=1 (on all ranks) has everything read without processes of their own, as it is where
// the system refuses to start one (a sandbox). Sound files give the same meshes, and nearly all damaged ones are
// refused as before; one that HDF5 cannot survive ends the job.

/// False where the environment variable PAMR_NO_FORK is set to anything but 0 or nothing, and where the system refuses
/// to start a process (tried once). Local.
bool may_fork();

/// A forked process that does something which may kill it and sends bytes back.
///
/// `produce` may use HDF5's serial driver and plain system calls, but neither MPI nor anything that other threads of
/// this process may hold. It runs under limits on processor time and memory, with standard streams and signal handlers
/// reset; no exit handler runs at its end.
class Subprocess {
 public:
  using Send = std::function<void(std::span<const char> bytes)>;
  struct Limits {
    rlim_t processor_seconds = 2;
    rlim_t memory_bytes = 0;  ///< beyond what this process has
  };
  /// What HDF5 may take to read a file of so many bytes: 16 times as much, and 64 MiB.
  static constexpr rlim_t memory_for(std::uintmax_t file_bytes) {
    return 16 * rlim_t{file_bytes} + (rlim_t{64} << 20U);
  }

  /// Forks. Throws `Error` when the system has no process or pipe left. Local.
  Subprocess(const std::function<void(const Send&)>& produce, Limits limits);
  /// Ends the process if it still runs.
  ~Subprocess();
  Subprocess(const Subprocess&) = delete;
  Subprocess& operator=(const Subprocess&) = delete;
  Subprocess(Subprocess&&) = delete;
  Subprocess& operator=(Subprocess&&) = delete;

  /// Waits for so many bytes; false when the process ended or stood still before.
  bool receive(std::span<char> to);
  /// Everything that it sends.
  std::string receive_all();
  /// Waits for its end. Returns what went wrong; empty: nothing.
  std::string end();

 private:
  /// One read; 0 at the end, or when nothing came for two minutes.
  std::size_t receive_some(std::span<char> to);
  void stop() noexcept;

  pid_t child_ = -1;
  int pipe_end_ = -1;
  int status_ = 0;
  bool stood_still_ = false;
};

}  // namespace pamr
