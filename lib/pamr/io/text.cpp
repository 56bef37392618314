// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/text.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "pamr/base/error.hpp"

namespace pamr::io {

bool is_clean_text(std::string_view text, std::string_view allowed_controls) {
  for (std::size_t i = 0; i < text.size();) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c < 0x80U) {
      if ((c < 0x20U || c == 0x7fU) && allowed_controls.find(text[i]) == std::string_view::npos) return false;
      ++i;
      continue;
    }
    const std::size_t length = c >= 0xf0U ? 4 : c >= 0xe0U ? 3 : 2;
    if (c < 0xc2U || c > 0xf4U || i + length > text.size()) return false;
    std::uint32_t code = c & (0x7fU >> length);
    for (std::size_t k = 1; k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      if ((next & 0xc0U) != 0x80U) return false;
      code = code << 6U | (next & 0x3fU);
    }
    if ((length == 3 && code < 0x800U) || (length == 4 && (code < 0x10000U || code > 0x10ffffU)) ||
        (code >= 0xd800U && code < 0xe000U))
      return false;
    i += length;
  }
  return true;
}

std::string shown_text(std::string_view text) {
  constexpr std::size_t longest = 60;
  std::string shown;
  for (const char c : text.substr(0, longest)) shown += c >= ' ' && c <= '~' ? c : '?';
  return shown + (text.size() > longest ? "..." : "");
}

void require_clean_name(std::string_view what, std::string_view name) {
  if (!is_clean_text(name, ""))
    throw Error(fmt::format("expected a name of {} in UTF-8 without tabs and other control characters, found '{}'",
                            what, shown_text(name)));
}

}  // namespace pamr::io
