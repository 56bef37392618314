// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "pamr/geometry/triangulated/named_parts.hpp"

namespace pamr::geometry {

/// The triangles of an OBJ file, with its groups and objects as parts, or of an OFF file. `where` begins errors. Throws
/// `Error` for bytes that are not a whole file of that format; `require_valid` is left to the caller. Local, linear.
NamedTriangulation parse_obj(std::string_view bytes, const std::string& where);
Triangulation parse_off(std::string_view bytes, const std::string& where);

}  // namespace pamr::geometry
