// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

namespace pamr {

/// A process, told from all others that there are and have been on any machine: for names of files that it leaves
/// where it is killed.
struct ProcessId {
  std::uint64_t machine = 0;  ///< 32 bits: hash of the running system (boot) and of its namespace of processes
  std::uint64_t process = 0;  ///< its number
  std::uint64_t start = 0;    ///< when it was started, in ticks since the system was; 0 where that is not known
};

/// Taken anew in a process that was forked. Local.
ProcessId this_process();

/// Whether the process has ended; nothing for one of another machine, of which nobody can tell here. Local.
std::optional<bool> has_ended(const ProcessId& id);

}  // namespace pamr
