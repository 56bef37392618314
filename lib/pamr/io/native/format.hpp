// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pamr::io {

/// Numbers of the native file's formats (docs/file-format.md). All of them are read.
inline constexpr int oldest_format = 1;
inline constexpr int newest_format = 4;
/// The first one that has a place for the map of level 0. Files of meshes without such a map have the number before.
inline constexpr int first_format_with_level0 = 3;
/// The first one that has a place for patches of faces inside.
inline constexpr int first_format_with_inner_patches = 4;

}  // namespace pamr::io
