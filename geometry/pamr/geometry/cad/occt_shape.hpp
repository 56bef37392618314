// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pamr::geometry {

/// The shape in a CAD file, lengths in millimeters.
struct OcctShape {
  TopoDS_Shape shape;
  std::string unit;                                         ///< length unit of the file, empty where it does not say
  std::vector<std::pair<TopoDS_Shape, std::string>> names;  ///< of faces that have one
  std::vector<std::pair<TopoDS_Shape, std::string>> solid_names;  ///< of solids that have one
  std::vector<std::pair<TopoDS_Shape, std::string>> colors;       ///< of faces, "#rrggbb" (sRGB)
  bool is_as_written = false;  ///< its curves were taken from the file, not made or mended by the reader of a format
};

/// Reads the text of a STEP, IGES or BREP file. Loose faces of an IGES file are sewn. Throws `Error`.
OcctShape read_occt_shape(std::string_view text);

}  // namespace pamr::geometry
