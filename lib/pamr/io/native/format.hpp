// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pamr::io {

/// Numbers of the native file's formats (docs/file-format.md). All of them are read.
inline constexpr int oldest_format = 1;
inline constexpr int newest_format = 2;

}  // namespace pamr::io
