// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstddef>
#include <string>
#include <type_traits>

namespace pamr::io {

/// Appends a number as text, a blank before it unless a line begins, with the digits that it takes to read it back.
template <class T>
void append_text(std::string& text, T value) {
  std::array<char, 40> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  if (!text.empty() && text.back() != '\n') text += ' ';
  text.append(digits.data(), end);
}

/// The same value with its bytes in the opposite order.
template <class T>
T byteswapped(T value) {
  static_assert(std::is_arithmetic_v<T>);
  auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
  std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

/// Appends the bytes of a number, the least first, or with `swap` the greatest.
template <class T>
void append_bytes(std::string& bytes, T value, bool swap = false) {
  static_assert(std::endian::native == std::endian::little);
  if (swap) value = byteswapped(value);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

}  // namespace pamr::io
