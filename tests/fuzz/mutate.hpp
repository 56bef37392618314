// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

namespace pamr::fuzz {

/// A damaged copy of a good file, always the same for the same seed. Of a text 2 in 3 are damaged in its structure, of
/// a file that begins with one 1 in 2 (`mutate_text.hpp`); of the others 1 in 7 is cut short, 3 have bytes flipped, 2 a
/// number of 1 to 8 bytes replaced by one that readers trip over, and 1 a block of bytes repeated, moved or zeroed.
std::string mutate(const std::string& good, std::uint64_t seed);

}  // namespace pamr::fuzz
