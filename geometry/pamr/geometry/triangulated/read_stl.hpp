// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "pamr/geometry/triangulated/named_parts.hpp"

namespace pamr::geometry {

/// The triangles of an STL file, ASCII or binary; equal points become one. Remarks say the names of several solids, and
/// how many bytes follow the triangles that a binary file announces. `where` begins errors. Throws `Error` for bytes
/// that are not a whole file of that format; `require_valid` is left to the caller. Local, linear.
NamedTriangulation parse_stl(std::string_view bytes, const std::string& where);

}  // namespace pamr::geometry
