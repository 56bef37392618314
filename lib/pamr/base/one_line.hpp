// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace pamr {

/// A message as it may go to a terminal: control characters, which names of files and contents of damaged ones may
/// hold, become \n, \x1b and so on. Those of one byte, and of two in UTF-8 (U+0080 to U+009F).
std::string one_line(std::string_view text);

}  // namespace pamr
