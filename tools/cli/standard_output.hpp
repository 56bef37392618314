// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace pamr::cli {

/// Has the numbers 0, 1 and 2 stand for streams that fail where the process has begun without them, so that no file that
/// MPI or this program opens gets them, and what is printed. Called before MPI begins. Local.
void keep_standard_streams();

/// Writes to standard output at once, in pieces where the launcher mixes up streams (`launcher_holds_lines_back`). True if
/// all of it has arrived; the first failure is remembered. Local.
bool print(const std::string& text);

/// The system's reason why something that was printed has not arrived (a full disk, a device that fails); empty: it
/// has, or there is no standard output, which is how some start programs that nobody listens to. Local.
std::string trouble_of_output();

}  // namespace pamr::cli
