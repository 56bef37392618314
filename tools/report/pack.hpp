// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace pamr::report {

/// Bytes as text, in base 64 (RFC 4648).
std::string base64(std::span<const unsigned char> bytes);

/// Bytes in the format of zlib (RFC 1950). Throws `std::runtime_error` where zlib has no memory.
std::vector<unsigned char> deflated(std::span<const unsigned char> plain);

/// Integers for a script in a page (page/unpack.js reads them): differences of neighbors with the sign in the lowest
/// bit, all first bytes, all second bytes, ..., as many as the largest difference needs; before them that number; all
/// of it deflated, in base 64.
std::string pack_integers(std::span<const std::int64_t> values);

/// Reals likewise, rounded to 16 significant bits (4 digits) in the range of 32-bit floats: the upper 3 bytes of each.
std::string pack_reals(std::span<const double> values);

}  // namespace pamr::report
