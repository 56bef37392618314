// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstdint>

namespace pamr {

/// Bijective mixing of 64 bits (the finaliser of splitmix64). Source: S. Vigna, public domain, after Stafford's
/// variant 13 of the MurmurHash3 finaliser.
constexpr std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

/// Hash of a sequence, one word at a time: `combine(combine(seed, a), b)` differs from `combine(combine(seed, b), a)`.
constexpr std::uint64_t combine(std::uint64_t seed, std::uint64_t word) { return mix(seed ^ mix(word)); }

/// Bits of a double with -0 folded onto +0, so that equal coordinates have equal hashes.
inline std::uint64_t bits_of(double value) { return std::bit_cast<std::uint64_t>(value + 0.0); }

}  // namespace pamr
