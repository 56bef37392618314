// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/triangulated/shells.hpp"
#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::surface_mesh {

/// How many there are, and where the first one is.
struct Found {
  std::int64_t count = 0;
  geometry::Vec3 where;
};

/// A hole or the end of an open surface: open edges that hang together.
struct Loop {
  std::int64_t n_edges = 0;
  double length = 0;
  double size = 0;       ///< diagonal of its box
  geometry::Vec3 where;  ///< one of its points
};

/// How far the triangles are off the smooth surface that the refiner puts through their points (sharp edges are kept),
/// at their middles.
struct Deviation {
  double mean = 0, worst = 0;  ///< mean by area
  geometry::Vec3 where;
};

/// What there is to say about triangles that may be a surface or not.
struct Description {
  std::int64_t n_points = 0, n_triangles = 0;
  geometry::Box box{{}, {}};  ///< around the points that are used
  double area = 0;
  double volume = 0;  ///< signed, by the divergence theorem: the body's if the surface is closed

  Found unused_points;
  Found coincident_points;    ///< points at the place of an earlier one
  Found flat_triangles;       ///< height below 1e-10 of the longest edge, or a point twice
  Found duplicate_triangles;  ///< the points of an earlier triangle
  Found open_edges;           ///< one triangle
  Found non_manifold_edges;   ///< more than two triangles
  Found non_manifold_points;  ///< several fans of triangles
  Found turned_edges;         ///< two triangles that run along it in the same sense: one of them is turned over
  std::vector<Loop> loops;    ///< largest first
  /// Largest area first. How they lie to one another is found together with `self_intersections`.
  std::vector<geometry::Shell> shells;
  Found turned_shells;   ///< closed ones seen from the wrong side (`geometry::turned_shells`), if there are several
  Found shell_contacts;  ///< pairs of shells that touch or cut each other
  std::optional<Found> self_intersections;  ///< pairs of triangles; nothing if not looked for (not a manifold)

  double min_edge = 0, mean_edge = 0, max_edge = 0;
  double min_angle = 0;  ///< smallest corner of a triangle, degrees
  geometry::Vec3 min_angle_where;
  std::int64_t sharp_edges = 0;        ///< two triangles that meet at more than the feature angle
  std::optional<Deviation> deviation;  ///< nothing if not looked for, or if the surface is not valid

  double diagonal() const { return box.diagonal(); }
  bool is_closed() const { return open_edges.count == 0; }
  /// Whether the triangles are one that `require_valid` of the geometry accepts, closed or not.
  bool is_surface() const;
  /// Whether `pamr-mesh` takes it for the surface of a body: valid, closed, not cutting itself, positive volume, shells
  /// inside of others seen from inside and outside in turn.
  bool is_body() const;
};

struct DescribeOptions {
  double feature_angle = 40;                   ///< degrees between two triangles, more is a sharp edge
  Exact<bool> find_self_intersections = true;  /// 1 s for a million triangles
  Exact<bool> find_deviation = true;           /// 7 s for a million triangles
};

/// Describes any triangles (`geometry::read_soup`). Local, serial. O(n log n).
Description describe(const geometry::Triangulation& surface, const DescribeOptions& options = {});

/// What keeps the triangles from being the surface of a body, one sentence each with the count and the first place;
/// nothing for `is_body`.
std::vector<std::string> faults_of(const Description& description);

}  // namespace pamr::surface_mesh
