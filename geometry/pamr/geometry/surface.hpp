// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>

#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// The creases of a surface, sharp edges inside it, and the smooth pieces between them.
class Creases {
 public:
  /// Number of the piece that is nearest to the point.
  virtual int piece_at(Vec3 point) const = 0;
  /// For an edge from a to b between the triangles (a, b, c) and (a, b, d): where the middle of its chord belongs when
  /// the edge runs along a crease. Its ends must lie next to each other on the crease, and the triangles, where it
  /// parts two pieces, on the two sides of it. Nothing elsewhere. The same for b and a, and for d and c.
  virtual std::optional<Vec3> crease_between(Vec3 a, Vec3 b, Vec3 c, Vec3 d) const = 0;

 protected:
  ~Creases() = default;
};

/// A curved or flat boundary. It knows points only, no mesh. Every call is local, thread-safe and gives the same bits
/// for the same point.
class Surface {
 public:
  virtual ~Surface() = default;
  Surface() = default;
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;
  Surface(Surface&&) = delete;
  Surface& operator=(Surface&&) = delete;

  /// Nearest point of the surface.
  virtual Vec3 project(Vec3 point) const = 0;
  /// Unit normal at the nearest point of the surface; its sense is the surface's own and continuous.
  virtual Vec3 normal(Vec3 point) const = 0;
  /// Distance to the nearest point, not negative.
  virtual double distance(Vec3 point) const { return norm(point - project(point)); }
  /// Nearest point of the curves along which pieces of the surface are joined (the circles of a profile's joints):
  /// where the border of two patches of one surface runs. The nearest point of the surface where it has no such curves.
  virtual Vec3 project_to_seam(Vec3 point) const { return project(point); }
  /// Distance with a sign: negative on the side to which the normal does not point.
  virtual double signed_distance(Vec3 point) const { return dot(point - project(point), normal(point)); }
  /// Its sharp edges, null where it is smooth.
  virtual const Creases* creases() const { return nullptr; }
  /// How far flat facets that the surface was made from lie off it near the point: 0 but for triangulated ones.
  virtual double facet_deviation(Vec3 /*point*/) const { return 0; }
  /// True when moving along a straight segment between two of its points stays on it (a plane): nothing to project.
  virtual bool is_flat() const { return false; }
  /// Bound of the coordinates and radii that the surface is made of. Rounding errors of `project` are relative to it
  /// and to the coordinates of the point.
  virtual double magnitude() const { return 0; }
};

/// Nearest point that lies on all the given surfaces (1: the surface, 2: their common curve, 3: their corner), found by
/// Newton steps of least length from `point`. Of two surfaces whose normals at `point` differ by under 5 degrees
/// (either sense) the nearer one is taken alone, the first among equals. `converged` is false when the surfaces have no
/// common point nearby (to 1e-13 of the size of the coordinates, and within 32 times the largest distance from the
/// start); `point` is then the best one found. More than three surfaces may meet in a corner; all of them count.
/// Depends on the coordinates and the order of the surfaces only. Cost: about 5 steps of one `project` and one `normal`
/// a surface.
struct Projected {
  Vec3 point;
  bool converged = true;
};
Projected project_onto_all(std::span<const Surface* const> surfaces, Vec3 point);

/// Largest distance of the point from the given surfaces.
double distance_from_all(std::span<const Surface* const> surfaces, Vec3 point);

}  // namespace pamr::geometry
