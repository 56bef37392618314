// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/parameters.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "pamr/base/error.hpp"

namespace pamr::geometry {

namespace {

[[noreturn]] void refuse(std::string_view what, std::string_view expected, const std::string& found) {
  throw Error(std::string(what) + ": expected " + std::string(expected) + ", found " + found);
}

}  // namespace

std::string decimal(double value) {
  std::array<char, 32> text{};
  auto* const last = text.data() + text.size();
  const bool needs_exponent = std::abs(value) >= 1e18;  // whole numbers of TOML have 64 bits
  char* const end = needs_exponent ? std::to_chars(text.data(), last, value, std::chars_format::scientific).ptr
                                   : std::to_chars(text.data(), last, value).ptr;
  return {text.data(), end};
}

std::string decimal(Vec3 value) {
  return "[" + decimal(value.x) + ", " + decimal(value.y) + ", " + decimal(value.z) + "]";
}

Vec3 checked_point(Vec3 point, std::string_view what) {
  if (!is_finite(point)) refuse(what, "three finite coordinates", decimal(point));
  return point;
}

Vec3 checked_direction(Vec3 vector, std::string_view what) {
  const double largest = largest_coordinate(vector);
  if (!is_finite(vector) || largest == 0) refuse(what, "a direction (finite and not zero)", decimal(vector));
  // Scaled by a power of two first, so that no square under- or overflows and [0, 2, 0] becomes exactly [0, 1, 0].
  const int exponent = std::ilogb(largest);
  const Vec3 scaled{std::scalbn(vector.x, -exponent), std::scalbn(vector.y, -exponent),
                    std::scalbn(vector.z, -exponent)};
  const double length = norm(scaled);
  return {scaled.x / length, scaled.y / length, scaled.z / length};
}

double checked_length(double length, std::string_view what) {
  if (!std::isfinite(length) || !(length > 0)) refuse(what, "a finite length greater than zero", decimal(length));
  return length;
}

}  // namespace pamr::geometry
