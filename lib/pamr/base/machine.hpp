// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

/// What this machine is and has.
namespace pamr {

/// A number of its own for every machine since it was last started. Local.
std::uint64_t machine_id();

/// Bytes of memory that the processes of this machine can have together: what is built in, with what it may put aside
/// on disk, or less where the group of this process is limited (cgroup). The greatest number where nobody tells. Local.
std::uint64_t memory_of_machine();

/// Bytes of address space that this process may have (`ulimit -v`). Local.
std::uint64_t memory_of_process();

}  // namespace pamr
