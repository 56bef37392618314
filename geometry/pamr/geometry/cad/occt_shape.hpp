// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <TopoDS_Shape.hxx>
#include <TopoDS_TShape.hxx>
#include <string>
#include <string_view>
#include <unordered_map>

namespace pamr::geometry {

/// Texts of faces or solids, by what the places of one part in an assembly have in common.
using OcctTexts = std::unordered_map<const TopoDS_TShape*, std::string>;
/// The text of a shape, empty where it has none.
std::string text_of(const OcctTexts& texts, const TopoDS_Shape& shape);

/// The shape in a CAD file, lengths in millimeters.
struct OcctShape {
  TopoDS_Shape shape;
  std::string unit;            ///< length unit of the file, empty where it does not say
  double tolerance = 0;        ///< that the file states, 0 where it does not
  OcctTexts names;             ///< of faces that have one
  OcctTexts solid_names;       ///< of solids that have one
  OcctTexts part_names;        ///< of solids: that of the part (product) of a STEP file
  OcctTexts colors;            ///< of faces, "#rrggbb" (sRGB)
  bool is_as_written = false;  ///< its curves were taken from the file, not made or mended by the reader of a format
};

/// Reads the text of a STEP, IGES or BREP file. Loose faces of an IGES file are sewn. Throws `Error`.
OcctShape read_occt_shape(std::string_view text);

}  // namespace pamr::geometry
