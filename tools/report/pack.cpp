// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/pack.hpp"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace pamr::report {

std::string base64(std::span<const unsigned char> bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8U | (k < n ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= n ? digits[word >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

std::vector<unsigned char> deflated(std::span<const unsigned char> plain) {
  uLongf size = compressBound(plain.size());
  std::vector<unsigned char> bytes(size);
  if (compress2(bytes.data(), &size, plain.data(), plain.size(), 6) != Z_OK)
    throw std::runtime_error("zlib could not compress a part of the report");
  bytes.resize(size);
  return bytes;
}

namespace {

/// The bytes of the codes, all lowest ones first, deflated.
std::string packed(const std::vector<std::uint64_t>& codes) {
  std::uint64_t all = 0;
  for (const auto code : codes) all |= code;
  const auto n_planes = static_cast<std::size_t>((std::bit_width(all) + 7) / 8);
  std::vector<unsigned char> plain{static_cast<unsigned char>(n_planes)};
  plain.reserve(1 + n_planes * codes.size());
  for (std::size_t plane = 0; plane < n_planes; ++plane)
    for (const auto code : codes) plain.push_back(static_cast<unsigned char>(code >> (8 * plane) & 0xffU));
  return base64(deflated(plain));
}

}  // namespace

std::string pack_integers(std::span<const std::int64_t> values) {
  std::vector<std::uint64_t> codes;
  codes.reserve(values.size());
  std::uint64_t last = 0;
  for (const auto value : values) {
    const auto word = static_cast<std::uint64_t>(value);
    const auto difference = word - last;
    codes.push_back(difference << 1U ^ (difference >> 63U != 0 ? ~std::uint64_t{0} : 0U));
    last = word;
  }
  return packed(codes);
}

std::string pack_reals(std::span<const double> values) {
  std::vector<std::uint64_t> codes;
  codes.reserve(values.size());
  for (const auto value : values) {
    const auto number = std::isnan(value) ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(value);
    const auto bits = std::bit_cast<std::uint32_t>(number);
    codes.push_back((std::isfinite(number) ? bits + 0x80U : bits) >> 8U);
  }
  return packed(codes);
}

}  // namespace pamr::report
