// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::geometry {

/// The triangles of an STL file, ASCII or binary; equal points become one. `where` begins errors. Throws `Error`
/// for bytes that are not a whole file of that format; `require_valid` is left to the caller. Local, linear.
Triangulation parse_stl(std::string_view bytes, const std::string& where);

/// The names of the solids in a text file, in order, empty ones too; none of a file in bytes.
std::vector<std::string> stl_solids(std::string_view bytes);

}  // namespace pamr::geometry
