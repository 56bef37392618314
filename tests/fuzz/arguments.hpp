// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <cstdlib>

namespace pamr::fuzz {

/// The whole number in argument `i` of a program, or another where there is none.
inline std::uint64_t number_in(int argc, char** argv, int i, std::uint64_t otherwise) {
  return argc > i ? std::strtoull(argv[i], nullptr, 10) : otherwise;
}

}  // namespace pamr::fuzz
