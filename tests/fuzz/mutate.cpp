// SPDX-License-Identifier: GPL-3.0-or-later
#include "mutate.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "mutate_text.hpp"
#include "support/dice.hpp"

namespace pamr::fuzz {

namespace {

/// A place in the file: half of the time in its first 4 KiB, where the structure of an HDF5 file starts.
std::size_t place(test::Dice& dice, std::size_t size) {
  constexpr std::size_t head = 4096;
  return dice.below(dice.below(2) == 0 && size > head ? head : size);
}

void flip_bytes(std::string& bytes, test::Dice& dice) {
  const auto n = 1 + dice.below(8);
  for (std::size_t i = 0; i < n; ++i) {
    auto& byte = bytes[place(dice, bytes.size())];
    byte = static_cast<char>(static_cast<unsigned char>(byte) ^ (1U + dice.below(255)));
  }
}

void replace_number(std::string& bytes, test::Dice& dice) {
  constexpr std::array<std::uint64_t, 10> values{0,
                                                 1,
                                                 0xffffffffffffffffU,
                                                 0x80000000U,
                                                 0x7fffffffU,
                                                 0x8000000000000000U,
                                                 0x7fffffffffffffffU,
                                                 0x7ff8000000000000U /* NaN */,
                                                 0x7ff0000000000000U /* infinity */,
                                                 0x100000000U};
  constexpr std::array<std::size_t, 4> widths{1, 2, 4, 8};
  const auto n = 1 + dice.below(3);
  for (std::size_t i = 0; i < n; ++i) {
    const auto value = values[dice.below(values.size())];
    const auto width = widths[dice.below(widths.size())];
    auto at = place(dice, bytes.size());
    if (dice.below(2) == 0) at -= at % width;
    if (at + width <= bytes.size()) std::memcpy(bytes.data() + at, &value, width);
  }
}

void move_block(std::string& bytes, test::Dice& dice) {
  const auto from = place(dice, bytes.size()), to = place(dice, bytes.size());
  const auto block = bytes.substr(from, 1 + dice.below(512));
  switch (dice.below(3)) {
    case 0:
      bytes.insert(to, block);
      break;
    case 1:
      bytes.replace(to, std::min(block.size(), bytes.size() - to), block);
      break;
    default:
      bytes.replace(from, block.size(), std::string(block.size(), '\0'));
      break;
  }
}

constexpr std::size_t min_text = 32;

/// Bytes of the text that a file is or begins with.
std::size_t length_of_text(const std::string& bytes) {
  const auto is_strange = [](char c) {
    const auto code = static_cast<unsigned char>(c);
    return (code < 0x20 && c != '\t' && c != '\r' && c != '\n') || code >= 0x7f;
  };
  return static_cast<std::size_t>(std::find_if(bytes.begin(), bytes.end(), is_strange) - bytes.begin());
}

}  // namespace

std::string mutate(const std::string& good, std::uint64_t seed) {
  test::Dice dice(seed);
  auto bytes = good;
  if (const auto size = length_of_text(good); size >= min_text && dice.below(size == good.size() ? 3 : 2) > 0) {
    auto text = good.substr(0, size);
    damage_text(text, dice);
    return text + good.substr(size);
  }
  switch (dice.below(7)) {
    case 0:
      bytes.resize(dice.below(bytes.size()));
      break;
    case 1:
    case 2:
    case 3:
      flip_bytes(bytes, dice);
      break;
    case 4:
    case 5:
      replace_number(bytes, dice);
      break;
    default:
      move_block(bytes, dice);
      break;
  }
  return bytes;
}

}  // namespace pamr::fuzz
