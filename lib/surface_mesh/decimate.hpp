// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/triangulated/triangulation.hpp"
#include "surface_mesh/surface_distance.hpp"

namespace pamr::surface_mesh {

struct DecimateOptions {
  double error = 0;                     ///< largest distance between the two surfaces, length unit; 0: none asked for
  Exact<std::int64_t> n_triangles = 0;  ///< ends when no more are left; 0: as few as the error allows
  double feature_angle = 40;            ///< degrees between two triangles, more is a sharp edge, which is kept
};

struct Decimated {
  geometry::Triangulation surface;
  std::int64_t n_sharp_edges = 0;    ///< of the input
  SurfaceDistance from_old, to_old;  ///< of the old surface from the new one, of the new one from the old one
  bool cuts_itself = false;          ///< the input did, and so does the result
  int n_rounds = 1;                  ///< how often it was done: with a smaller tolerance or more points fixed each time
  std::int64_t n_fixed = 0;          ///< points that were fixed in the end, to undo what was wrong
};

/// Removes points by collapsing edges in the order of the quadric error, with OpenMesh; points that stay keep their
/// bits.
/// - Sharp edges stay: their points move along them only, where three or more meet, or one ends, a point stays. So do
///   the ends of an open surface, and without an error their points stay altogether.
/// - No triangle turns by more than 60 degrees in a step or gets a height below a twentieth of its longest side, unless
///   a worse one goes.
/// - With an error, no point of either surface is farther than that from the other one: `at_most` of both distances is
///   a proved bound and never larger. Where it is not proved, an old point is fixed and it is done again; after some
///   rounds with more and more neighbors, in the end with all points.
/// - The result does not cut itself unless the input does, and a closed surface is not turned inside out by an error as
///   large as its body; triangles that would are undone in the same way.
/// Local, serial; 13 s and 0.4 GB for a million triangles without an error. Pre: the surface is valid, closed or not.
/// Source: M. Garland, P. Heckbert, Surface simplification using quadric error metrics, 1997; R. Klein, G. Liebich,
/// W. Strasser, Mesh reduction with error control, 1996.
Decimated decimate(const geometry::Triangulation& surface, const DecimateOptions& options);

}  // namespace pamr::surface_mesh
