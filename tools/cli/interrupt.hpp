// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace pamr::cli {

/// Has SIGINT, SIGTERM, SIGHUP and SIGUSR1 remove what is unfinished (`io::RemoveOnInterrupt`), say so if this process
/// `speaks`, and end it with exit code 6, half a second later if it is one of several ranks. A SIGHUP that the process
/// ignores (nohup) stays ignored. Local.
void end_well_on_interrupt(const std::string& tool, bool speaks, bool in_company);

/// From here on an interrupt ends this process without a word: its work has failed, and it says how. Local.
void be_silent_on_interrupt();

/// From here on all ranks have done their work, and outputs are complete. Interrupts are ignored; a signal of a crash,
/// of MPI while it ends or of another library, is a warning, and the exit code is `code`. Local.
void keep_outcome(const std::string& tool, int code);

/// Called before this process ends all others because of an error that it has told: mpirun then has SIGTERM end them,
/// and they are to be silent. Exact on one machine; on several another line may follow the error. Local.
void announce_abort();

}  // namespace pamr::cli
