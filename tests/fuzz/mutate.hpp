// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

namespace pamr::fuzz {

/// A damaged copy of a good file, always the same for the same seed: cut short (1 in 7), bytes flipped (3 in 7), a
/// number replaced by one that readers trip over (2 in 7), a block of bytes repeated, moved or zeroed (1 in 7).
std::string mutate(const std::string& good, std::uint64_t seed);

}  // namespace pamr::fuzz
