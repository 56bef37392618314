// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace pamr {

/// "1 cell was", "2 cells were": a number before the words that go with it. Local.
inline std::string counted(std::int64_t n, std::string_view of_one, std::string_view of_others) {
  return std::to_string(n) + ' ' + std::string(n == 1 ? of_one : of_others);
}

}  // namespace pamr
