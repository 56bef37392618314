// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "report/first_view.hpp"

namespace pamr::report {

/// Colors of classes, as in pamr-picture: patches after Okabe and Ito, levels from light to loud.
inline constexpr std::array<std::string_view, 8> patch_colors{"#f0be5a", "#82c3eb", "#5abe96", "#f0e478",
                                                              "#6e96cd", "#e1875f", "#d7a5c3", "#aaaaaa"};
inline constexpr std::array<std::string_view, 8> level_colors{"#c3ccd8", "#58aabb", "#edb25c", "#d4566a",
                                                              "#9a7cc6", "#68b078", "#b48c64", "#707070"};

/// The first view as a PNG, 1000 x 560 pixels without a ground: what a page shows before its script draws, and where
/// none can draw. Drawn here, triangle by triangle, into a buffer of depths, twice as fine as the picture. The same
/// bytes for the same meshes. Local; about 10 ms and 1e-7 s a triangle.
std::string still_picture(const std::vector<ReportedMesh>& meshes, const FirstView& first);

}  // namespace pamr::report
