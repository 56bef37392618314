// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <memory>

#include "pamr/geometry/cad/cad_data.hpp"

namespace pamr::geometry {

/// The surface of a face without its borders, coordinates times `scale`. It asks the geometry itself, never one of
/// OpenCASCADE's adaptors, which remember the span of a spline that was asked last.
std::shared_ptr<const ParametricSurface> occt_surface(const TopoDS_Face& face, double scale);
bool is_occt_plane(const TopoDS_Face& face);

/// The curve of an edge and its ends; null where it has none.
struct OcctCurve {
  std::shared_ptr<const ParametricCurve> curve;
  double begin = 0, end = 0;
};
OcctCurve occt_curve(const TopoDS_Edge& edge, double scale);

}  // namespace pamr::geometry
