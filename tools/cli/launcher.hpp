// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

namespace pamr::cli {

/// Whether a launcher of MPI has started this process and takes its output. Local.
bool is_under_launcher();

/// Whether that is the launcher of Open MPI 5, PRRTE. It passes whole lines on: the beginning of a line waits for its
/// end, and is put before whatever comes next, of any stream of this rank and of the same stream of the others. Local.
///
/// Source: openpmix/openpmix, src/common/pmix_iof.c, pmix_iof_write_output, where a residual is looked for by rank *or*
/// stream.
bool launcher_holds_lines_back();

/// How many bytes the parent of this process, which may be the launcher, has read in all, from files, pipes and
/// terminals; none where the system does not count them. Local.
std::optional<std::uint64_t> bytes_read_by_parent();

}  // namespace pamr::cli
