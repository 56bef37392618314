// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace pamr::cli {

/// Has SIGINT, SIGTERM, SIGHUP and SIGUSR1 remove what is unfinished (`io::RemoveOnInterrupt`), say so if this process
/// `speaks`, and end it with exit code 6, half a second later if it is one of several ranks. A SIGHUP that the process
/// ignores (nohup) stays ignored. Local.
void end_well_on_interrupt(const std::string& tool, bool speaks, bool in_company);

/// From here on an interrupt ends this process without a word: its work is over, and it has said how. Local.
void be_silent_on_interrupt();

/// Called before this process ends all others because of an error that it has told: mpirun then has SIGTERM end them,
/// and they are to be silent. Exact on one machine; on several another line may follow the error. Local.
void announce_abort();

}  // namespace pamr::cli
