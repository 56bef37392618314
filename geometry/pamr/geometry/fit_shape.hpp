// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "pamr/geometry/described_surface.hpp"
#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// The curved shapes that a patch of a mesh may turn out to lie on.
enum class ShapeKind { sphere, cylinder, cone, torus };
inline constexpr std::array shape_kinds{ShapeKind::sphere, ShapeKind::cylinder, ShapeKind::cone, ShapeKind::torus};

/// "sphere" and so on, as in the description of a surface.
std::string_view name_of(ShapeKind kind);
/// Numbers that a shape of this kind is given by: 4, 5, 6 and 7.
int n_unknowns(ShapeKind kind);

struct FittedShape {
  ShapeKind kind = ShapeKind::sphere;
  Vec3 place;          ///< center, point on the axis, or apex
  Vec3 axis{0, 0, 1};  ///< of any length but zero; the nappe of a cone lies on its side; of no meaning for a sphere
  double radius = 0;   ///< the major one of a torus; of a cone the half angle, radians
  double of_tube = 0;  ///< minor radius of a torus

  /// Distance of a point from it, with sign: positive outside. Pre: the axis has length 1.
  double signed_distance(Vec3 point) const;
  /// Largest curvature of the shape near the point on it: infinite at the apex of a cone.
  double curvature(Vec3 point) const;
};

struct ShapeFit {
  FittedShape shape;
  double worst = 0;  ///< largest distance of a point, length unit
};

/// The shape of that kind that fits points best, given an approximate unit normal at each, all to the same side.
/// Least squares of the distances; where most points fit far better than the rest, of the three quarters that fit best.
/// The parameters are rounded to the shortest decimals that fit as well. Nothing where there are fewer than three
/// points for each unknown, where points are off by more than 1e-6 of the size of their box, where they lie nearly in
/// a plane (within 1e-4 of that size, or a thousand times the distance from the shape), and where the shape is a
/// thousand times larger than they, or none of its kind.
/// Deterministic; depends on the order of the points in the last bits. Cost: some 500 passes over them.
std::optional<ShapeFit> fit_shape(ShapeKind kind, std::span<const Vec3> point, std::span<const Vec3> normal);

/// The shape as a surface.
DescribedSurface described_shape(const std::string& name, const FittedShape& shape);

}  // namespace pamr::geometry
