// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <TopoDS_Shape.hxx>

#include "pamr/geometry/cad/read_cad.hpp"

namespace pamr::geometry {

/// Gives each edge its curve in space and each face triangles, not farther from it than `deflection` times the size of
/// the shape. Throws `Error` for a shape without size.
void triangulate(const TopoDS_Shape& shape, double deflection);

/// The triangles of all faces in the order of the faces; what lies on one edge or vertex in several faces becomes one
/// point, by the shape's topology and not by distance. Coordinates times `scale`. Pre: `triangulate`.
CadTriangles welded_triangles(const TopoDS_Shape& shape, double scale);

}  // namespace pamr::geometry
