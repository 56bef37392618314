// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/png.hpp"

#include <zlib.h>

#include <cstdint>
#include <vector>

#include "report/pack.hpp"

namespace pamr::report {

namespace {

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xffU);
  return bytes;
}

std::string chunk(const std::string& kind, const std::string& data) {
  const auto content = kind + data;
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size()));
  return big_endian(static_cast<std::uint32_t>(data.size())) + content + big_endian(static_cast<std::uint32_t>(sum));
}

}  // namespace

std::string png(int width, int height, std::span<const unsigned char> pixels) {
  const auto row = static_cast<std::size_t>(width) * 4;
  std::vector<unsigned char> plain;
  plain.reserve(pixels.size() + static_cast<std::size_t>(height));
  for (std::size_t begin = 0; begin < pixels.size(); begin += row) {
    plain.push_back(0);  // filter of a row: none
    const auto part = pixels.subspan(begin, row);
    plain.insert(plain.end(), part.begin(), part.end());
  }
  const auto packed = deflated(plain);
  const auto size = big_endian(static_cast<std::uint32_t>(width)) + big_endian(static_cast<std::uint32_t>(height));
  return std::string("\x89PNG\r\n\x1a\n") + chunk("IHDR", size + std::string("\x08\x06\x00\x00\x00", 5)) +
         chunk("IDAT", {packed.begin(), packed.end()}) + chunk("IEND", "");
}

}  // namespace pamr::report
