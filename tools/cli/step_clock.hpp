// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace pamr::cli {

/// Whether standard error ends at a terminal where lines can change: that of this process or, under mpirun, which takes it
/// through a pipe, that of the process that started it, unless that shows whole lines only. Local.
bool error_is_on_terminal();

/// Says on standard error that this work is under way, and for how long: on a terminal every second in one line,
/// elsewhere every ten seconds in a line of its own, also while a single call works. Work that is over sooner says
/// nothing. One step at a time: the next one takes the place of the one before. Local.
///
/// By a timer and its signal (SIGALRM), not by a thread, which would take address space.
void show_step(const std::string& what);
/// Ends that, and takes the line off the terminal, also one that `mark_line` told of. Local.
void hide_step();
/// Tells whether a line that others have written to the terminal, without an end, stands there. Local.
void mark_line(bool is_drawn);

}  // namespace pamr::cli
