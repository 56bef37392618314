// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace pamr {

/// With which some editors begin a text in UTF-8.
inline constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

/// A text from behind the mark on, where it begins with one.
constexpr std::string_view without_byte_order_mark(std::string_view text) {
  return text.starts_with(byte_order_mark) ? text.substr(byte_order_mark.size()) : text;
}

}  // namespace pamr
