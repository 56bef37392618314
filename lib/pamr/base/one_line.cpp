// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/one_line.hpp"

#include <fmt/format.h>

namespace pamr {

std::string one_line(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : '\0');
    if (c == '\n') {
      result += "\\n";
    } else if (c < 0x20U || c == 0x7fU) {
      result += fmt::format("\\x{:02x}", c);
    } else if (c == 0xc2U && next >= 0x80U && next < 0xa0U) {
      result += fmt::format("\\x{:02x}", next);
      ++i;
    } else {
      result += text[i];
    }
  }
  return result;
}

}  // namespace pamr
