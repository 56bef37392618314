// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::surface_mesh {

struct RemeshOptions {
  double size = 0;            ///< edge length to reach
  double feature_angle = 40;  ///< degrees between two triangles, more is a sharp edge, which is kept and split
  Exact<int> n_steps = 3;
};

struct Remeshed {
  geometry::Triangulation surface;
  std::int64_t n_sharp_edges = 0;  ///< of the input
};

/// New triangles of even size on the same flat ones, by CGAL's isotropic remeshing. Sharp edges and the ends of an open
/// surface keep their lines. Local, serial; 10 s for 100,000 triangles. Pre: the surface is valid, closed or not.
/// Source: M. Botsch, L. Kobbelt, A remeshing approach to multiresolution modeling, 2004.
Remeshed remesh(const geometry::Triangulation& surface, const RemeshOptions& options);

}  // namespace pamr::surface_mesh
