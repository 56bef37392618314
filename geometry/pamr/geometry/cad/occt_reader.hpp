// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

#include "pamr/geometry/cad/read_cad.hpp"

namespace pamr::geometry {

/// `read_cad`, `triangulate_cad` and `measure_cad` by OpenCASCADE.
CadData occt_read(std::string_view text, double scale);
CadTriangles occt_triangles(std::string_view text, double scale, double deflection);
CadMeasures occt_measure(std::string_view text, double scale);

}  // namespace pamr::geometry
