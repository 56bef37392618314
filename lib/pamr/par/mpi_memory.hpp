// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pamr::par {

/// Whether this process, one of so many ranks, may take as much memory as MPI does when ranks speak to each other for
/// the first time or open a file together. Where it is missing on one rank in the middle of that, Open MPI 4.1 waits
/// for ever on the others; so it is asked for before. One rank alone needs none. Local.
bool has_mpi_memory(int n_ranks);

}  // namespace pamr::par
