// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "pamr/geometry/cad/read_cad.hpp"

namespace pamr::geometry {

/// `read_cad`, `triangulate_cad`, `assemble_cad` and `measure_cad` by OpenCASCADE.
struct CadReader {
  CadData (*read)(std::string_view text, double scale);
  CadTriangles (*triangulate)(std::string_view text, double scale, double deflection, bool is_assembly);
  CadAssembly (*assemble)(std::string_view text, double scale, std::span<const std::string> chosen);
  CadMeasures (*measure)(std::string_view text, double scale);
};

}  // namespace pamr::geometry

/// All that the library pamr_cad shows of itself. It is loaded when the first CAD file is read: OpenCASCADE takes 40 ms
/// to load, as long as all else that most runs do.
extern "C" const pamr::geometry::CadReader* pamr_cad_reader();
