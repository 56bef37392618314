// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pamr::par {

/// Makes a program that a rank of an MPI job has started (a solver under mpirun that calls a tool) a job of its own
/// with one process: it inherits variables by which MPI would take it for that rank, and these are taken out of the
/// environment. True if that was so. Does nothing for a program that mpirun has started, also through a script. To be
/// called before MPI is initialized, before any thread. Local. Where there is no /proc it finds nothing.
bool leave_parent_job();

}  // namespace pamr::par
