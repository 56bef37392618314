// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/triangulated/named_parts.hpp"
#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::geometry {

/// Reads a surface of triangles, or of faces with more corners, which are split (`Polygons`), from STL (ASCII, binary), OBJ, PLY (ASCII, binary of either byte order) or OFF; the
/// extension of the name says which, in either case. Points of STL that are equal in all coordinates become one; points
/// that no triangle uses are dropped. `name` is left empty. Only whole files are taken: what a file announces is there,
/// `remarks` say what is left out, numbers are finite, and the surface passes `require_valid`. Throws `Error` with the file and the
/// line or triangle otherwise. Local; memory in proportion to the file, whatever it announces.
Triangulation read_triangulation(const std::filesystem::path& file, Exact<bool> open_allowed = false);

/// The same for the bytes of a file; `where` names it in errors, and its extension is the format.
Triangulation parse_triangulation(std::string_view bytes, const std::string& where, Exact<bool> open_allowed = false);

/// The same with those named parts of the file that are chosen: two or more of different names, else none; remarks say
/// which names are left out. Throws `Error` also where parts have triangles of their own on both sides of a common face,
/// as touching bodies.
NamedTriangulation read_named_triangulation(
    const std::filesystem::path& file, Exact<bool> open_allowed = false,
    const PartChoice& is_part = [](const std::string&) { return true; });

/// The triangles and points of such a file as they stand there: whole files, finite coordinates below 1e30, points
/// that exist, but any surface, empty ones too. For tools that say what is wrong with a surface; the others take
/// `read_triangulation`. Throws `Error` otherwise. Local.
Triangulation read_soup(const std::filesystem::path& file);

/// The same for the bytes of a file; `where` names it in errors, and its extension is the format.
Triangulation parse_soup(std::string_view bytes, const std::string& where);

}  // namespace pamr::geometry
