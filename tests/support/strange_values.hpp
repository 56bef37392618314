// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

#include "support/dice.hpp"

/// Values at the ends of what there is, for tests of what readers accept.
namespace pamr::test {

/// A word of 64 bits, an integer or a floating-point number.
inline std::uint64_t strange_word(Dice& dice) {
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
  const std::array<std::uint64_t, 16> words{0,
                                            1,
                                            ~std::uint64_t{0},
                                            std::uint64_t{1} << 63U,
                                            (std::uint64_t{1} << 63U) - 1,
                                            std::uint64_t{1} << 31U,
                                            std::uint64_t{1} << 53U,
                                            bits(std::nan("")),
                                            bits(std::numeric_limits<double>::infinity()),
                                            bits(-std::numeric_limits<double>::infinity()),
                                            bits(1e300),
                                            bits(-1e300),
                                            bits(5e-324),
                                            bits(1e-300),
                                            bits(1.0),
                                            bits(-1.0)};
  return words.at(dice.below(words.size()));
}

inline nlohmann::json strange_value(Dice& dice) {
  using nlohmann::json;
  const std::array<json, 14> values{nullptr,
                                    true,
                                    false,
                                    0,
                                    -1,
                                    1,
                                    1e300,
                                    -1e300,
                                    0.5,
                                    std::int64_t{1} << 62U,
                                    "x",
                                    json::array(),
                                    json::object(),
                                    ~std::uint64_t{0}};
  return values.at(dice.below(values.size()));
}

/// Replaces, removes or repeats a part that dice choose.
inline void damage_json(nlohmann::json& whole, Dice& dice) {
  auto* place = &whole;
  do {
    auto item = place->begin();
    std::advance(item, static_cast<std::ptrdiff_t>(dice.below(place->size())));
    if (dice.below(12) == 0) {
      if (place->is_array())
        place->push_back(nlohmann::json(*item));
      else
        place->erase(item);
      return;
    }
    place = &*item;
  } while (place->is_structured() && !place->empty() && dice.below(6) > 0);
  *place = strange_value(dice);
}

}  // namespace pamr::test
