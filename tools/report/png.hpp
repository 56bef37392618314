// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>

namespace pamr::report {

/// The bytes of a PNG file (W3C, third edition). `pixels`: width x height x 4 bytes, red, green, blue and opacity, row
/// by row from the top. Local.
std::string png(int width, int height, std::span<const unsigned char> pixels);

}  // namespace pamr::report
