// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::surface_mesh {

enum class SubdivisionScheme {
  midpoint,   ///< points in the middles of edges: the same surface
  loop,       ///< Loop: smooth, points move, sharp edges are rounded
  butterfly,  ///< modified butterfly: smooth, old points stay, sharp edges are rounded
};

/// Splits every triangle into four, `n_steps` times; the smooth schemes with OpenMesh. Local, serial. Pre: the surface
/// is valid, closed or not. Source: C. Loop, Smooth subdivision surfaces based on triangles, 1987; D. Zorin, P.
/// Schroeder, W. Sweldens, Interpolating subdivision for meshes with arbitrary topology, 1996.
geometry::Triangulation subdivide(const geometry::Triangulation& surface, SubdivisionScheme scheme, int n_steps);

}  // namespace pamr::surface_mesh
