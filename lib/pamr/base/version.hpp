// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

/// The version of these headers, from which CMake and packages have theirs.
#define PAMR_VERSION_MAJOR 0
#define PAMR_VERSION_MINOR 3
#define PAMR_VERSION_PATCH 0

namespace pamr {

/// The version of the library that the program holds, such as "0.3.0". Local.
std::string_view version();

}  // namespace pamr
