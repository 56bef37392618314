// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace pamr::fuzz {

/// From here on, the largest piece of memory given is noted, in this process and in those forked from it. The
/// program's own `malloc` stands before the C library's, so the libraries' requests are seen too.
void watch_memory();
/// Largest piece given since the last call, in bytes.
std::size_t largest_piece();

}  // namespace pamr::fuzz
