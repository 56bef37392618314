// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace pamr::cli {

/// Has SIGINT, SIGTERM, SIGHUP and SIGUSR1 remove what is unfinished (`io::RemoveOnInterrupt`), say so and what is
/// complete (`io::complete_outputs`) if this process `speaks`, and end it with exit code 6, half a second later if it
/// is one of several ranks. A SIGHUP that the process ignored when it began (nohup) stays ignored. Local.
void end_well_on_interrupt(const std::string& tool, bool speaks, bool in_company);

/// From here on an interrupt ends this process without a word: its work has failed, and it says how. Local.
void be_silent_on_interrupt();

/// Has a process that crashes say first which outputs are complete (`io::complete_outputs`), if any are; it then ends
/// as it would have done. Local.
void tell_of_crash(const std::string& tool);

/// Called before MPI begins and libraries say what they do when the process ends: lets `keep_outcome` have the last
/// word. Local.
void guard_exit_code();

/// From here on all ranks have done their work, and outputs are complete, or `is_error` and it has been printed. The
/// exit code is `code`, also after a signal of a crash, of MPI while it ends or of another library, or where one of
/// these chooses another code: that is a warning, or nothing after an error. Interrupts are ignored, but after an
/// error: mpirun sends them to the ranks that are not the first to leave. Local. Open MPI 4 crashes in one of some
/// thousand calls of MPI_Finalize (open-mpi/ompi, issue 10117).
void keep_outcome(const std::string& tool, int code, bool is_error);

/// Called before this process ends all others because of an error that it has told: mpirun then has SIGTERM end them,
/// and they are to be silent. Exact on one machine; on several another line may follow the error. Local.
void announce_abort();

}  // namespace pamr::cli
