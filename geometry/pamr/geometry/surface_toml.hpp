// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/base/toml_table.hpp"
#include "pamr/geometry/surface_set.hpp"
#include "pamr/geometry/triangulated/named_parts.hpp"
#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// Reads the surfaces of a mesh from TOML text: an array of tables `[[surface]]` with `name`, `kind` and the parameters
/// of the kind (docs/surfaces.md). Surfaces of kind `triangulation` are made from the one of their name among
/// `triangulations`: no file is read. The set keeps the text and all of `triangulations`. `where` begins errors. Local.
/// Throws `Error` with line and column for an unknown kind, key, type or value out of range, and for a triangulation
/// that is not there or not valid. O(n log n) in the number of triangles.
SurfaceSet surfaces_from_toml(std::string_view text, std::string_view where,
                              std::vector<std::shared_ptr<const Triangulation>> triangulations = {});

/// The surfaces of a case file: its tables `[[surface]]`, which become the description, each from its line on.
/// Triangles come from the files that they name; a relative `file` counts from the folder of `where`. Unknown keys are
/// left to `finish` of the file. `is_part`: which named parts of a file of triangles (`read_named_triangulation`) divide
/// it; the description gets their borders.
SurfaceSet surfaces_of_case(const TomlTable& file, const std::string& where, const PartChoice& is_part = nullptr);

/// The line of a description, without its end, that holds the borders of the parts of a surface; empty where they have
/// none.
std::string border_edges_line(const Triangulation& surface, const NamedParts& parts);

/// The keys that describe a plane, `separator` between them.
std::string plane_keys(const std::string& name, Vec3 point, Vec3 normal, std::string_view separator);

/// Text as a string of TOML. Pre: no control characters.
std::string toml_text(std::string_view text);

}  // namespace pamr::geometry
