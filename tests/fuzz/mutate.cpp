// SPDX-License-Identifier: GPL-3.0-or-later
#include "mutate.hpp"

#include <array>
#include <cstring>

#include "pamr/base/hash.hpp"

namespace pamr::fuzz {

namespace {

/// Counter-based random numbers.
class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed) {}
  std::uint64_t next() { return combine(seed_, ++count_); }
  std::size_t below(std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(next() % n); }

 private:
  std::uint64_t seed_, count_ = 0;
};

/// A place in the file: half of the time in its first 4 KiB, where the structure of an HDF5 file starts.
std::size_t place(Random& random, std::size_t size) {
  constexpr std::size_t head = 4096;
  return random.below(random.below(2) == 0 && size > head ? head : size);
}

void flip_bytes(std::string& bytes, Random& random) {
  const auto n = 1 + random.below(8);
  for (std::size_t i = 0; i < n; ++i) {
    auto& byte = bytes[place(random, bytes.size())];
    byte = static_cast<char>(static_cast<unsigned char>(byte) ^ (1U + random.below(255)));
  }
}

void replace_number(std::string& bytes, Random& random) {
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
  const auto n = 1 + random.below(3);
  for (std::size_t i = 0; i < n; ++i) {
    const auto value = values[random.below(values.size())];
    const auto width = widths[random.below(widths.size())];
    auto at = place(random, bytes.size());
    if (random.below(2) == 0) at -= at % width;
    if (at + width <= bytes.size()) std::memcpy(bytes.data() + at, &value, width);
  }
}

void move_block(std::string& bytes, Random& random) {
  const auto from = place(random, bytes.size()), to = place(random, bytes.size());
  const auto block = bytes.substr(from, 1 + random.below(512));
  switch (random.below(3)) {
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

}  // namespace

std::string mutate(const std::string& good, std::uint64_t seed) {
  Random random(seed);
  auto bytes = good;
  switch (random.below(7)) {
    case 0:
      bytes.resize(random.below(bytes.size()));
      break;
    case 1:
    case 2:
    case 3:
      flip_bytes(bytes, random);
      break;
    case 4:
    case 5:
      replace_number(bytes, random);
      break;
    default:
      move_block(bytes, random);
      break;
  }
  return bytes;
}

}  // namespace pamr::fuzz
