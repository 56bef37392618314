// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "pamr/geometry/triangulated/check_triangulation.hpp"
#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::geometry {

/// An edge of a triangulation that stays sharp, one at which the surface ends, or a border of named parts: the two
/// points, and the tangent there of the curve through the creases, along the edge from the first point to the second.
struct Crease {
  std::array<int, 2> point{};
  std::array<Vec3, 2> tangent{};
};

/// What a triangulation says about the smooth surface that it was made from.
struct Features {
  std::vector<std::array<Beyond, 3>> neighbor;  ///< n_triangles x 3, see `triangle_neighbors`
  std::vector<std::array<int, 3>> crease_at;    ///< n_triangles x 3, number of the crease at the edge or -1
  std::vector<Crease> creases;                  ///< in the order of their first triangle
  std::vector<int> patch;                       ///< n_triangles, the piece between creases that it belongs to
  std::vector<std::array<Vec3, 3>> normal;      ///< n_triangles x 3, unit normals at the corners, one-sided
  std::vector<char> is_planar;                  ///< by patch: all its triangles in one plane, to 1e-9 of its size
  std::vector<Vec3> plane_normal, plane_point;  ///< by patch, of its largest triangle
};

/// What makes an edge a crease.
struct CreaseOptions {
  double angle = 40;  ///< degrees between the normals of two triangles, more is a crease; 180: none by angle
  /// Creases given as polylines: every edge with both ends on one of their segments.
  std::vector<std::vector<Vec3>> given{};
  /// Edges at which pieces end as well, the two points of each: where named parts of a file meet. Between two pieces
  /// that are not planar such an edge is no crease in shape: the surface stays smooth there.
  std::vector<std::array<int, 2>> borders{};
  /// Creases that end inside a piece and are shorter than this, all that hang together, are none: noise. Length unit.
  double shortest = 0;
};

/// Finds creases, and the normals and tangents of the smooth surface at the points. Normals come from fitted quadrics
/// (`jet_normal`) over two rings of triangles on the same side of the creases, tangents from the circle through a point
/// and its two neighbors along the crease; a crease turns freely where not exactly two meet, or where it turns by more
/// than 75 degrees. The surface must be valid. Throws `Error` for a segment of a given crease that no edge lies on (to
/// 1e-6 of the size of the surface), and for borders that are no edges of the surface. O(n log n), and O(n) for each
/// segment of a given crease.
Features find_features(const Triangulation& surface, const CreaseOptions& options);

/// The edges between triangles of different parts (n_triangles), the lower point first, ascending. Local, O(n log n).
std::vector<std::array<int, 2>> borders_of(const Triangulation& surface, const std::vector<int>& part);

}  // namespace pamr::geometry
