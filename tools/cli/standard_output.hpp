// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace pamr::cli {

/// Writes to standard output at once and remembers the first failure. Local.
void print(const std::string& text);

/// The system's reason why something that was printed has not arrived (a full disk, a device that fails); empty: it
/// has, or there is no standard output, which is how some start programs that nobody listens to. Local.
std::string trouble_of_output();

}  // namespace pamr::cli
