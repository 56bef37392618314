// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::surface_mesh {

/// Single steps of a repair that CGAL's Polygon_mesh_processing does. Each returns what it changed. Local, serial.

/// What orienting did.
struct Oriented {
  std::int64_t n_turned = 0;      ///< triangles turned over
  std::int64_t n_cut_edges = 0;   ///< edges with more than two triangles, now open edges of each
  std::int64_t n_new_points = 0;  ///< copies of points where triangles were parted
};
/// Gives neighbors the same orientation and makes a manifold: where more than two triangles meet in an edge, or several
/// fans in a point, they are parted. Of each piece that hangs together the smaller area is turned. Pre: no triangle
/// twice or with a point twice.
Oriented orient_and_part(geometry::Triangulation& surface);

/// Joins open edges at the same place into inner ones, where that leaves a manifold. Returns how many pairs. Pre: a
/// manifold of one orientation, like below.
std::int64_t stitch(geometry::Triangulation& surface);

/// What closing holes did.
struct ClosedHoles {
  std::int64_t n_holes = 0, n_triangles = 0, n_points = 0;
  std::int64_t n_large = 0;   ///< left: larger than asked for, or more than 500 edges
  std::int64_t n_failed = 0;  ///< left: CGAL found no triangulation
};
/// Fills holes whose box has a diagonal up to `max_size`: triangulated, refined to the size of the triangles around,
/// and smooth with them.
ClosedHoles close_holes(geometry::Triangulation& surface, double max_size);

/// Triangles that cut others, in order. Pre: a manifold of one orientation.
std::vector<int> cutting_triangles(const geometry::Triangulation& surface);

/// What resolving self-intersections did.
struct Resolved {
  std::int64_t n_pairs = 0;                 ///< of triangles that cut each other, before
  std::int64_t n_pairs_left = 0;            ///< after
  std::int64_t n_removed = 0, n_added = 0;  ///< triangles
};
/// Takes triangles that cut each other out with their neighbors and fills the holes again, with more neighbors each
/// time as long as that helps. Ends of open surfaces are left alone. Changes nothing if a tenth of all triangles are
/// concerned: these are bodies that overlap.
Resolved resolve_intersections(geometry::Triangulation& surface);

}  // namespace pamr::surface_mesh
