// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <TopoDS_Shape.hxx>
#include <array>
#include <gp_Pnt.hxx>
#include <optional>

namespace pamr::geometry {

/// A point in which two solids touch, or the boundary of one touches itself.
struct TangentPoint {
  std::array<int, 2> solid{};  ///< numbers from 1 on, in the order of `TopExp::MapShapes`, ascending
  gp_Pnt point;
};

/// A point of fused solids around which a gap, or a wall beside an inner solid, is thinner than any edge of a mesh: two
/// faces touch there without an edge in common, one boundary is smooth, and a face or an edge of the other is tangent
/// to it (a ball on a plate, a tilted wheel), or edges of both are tangent. Nothing where all such gaps open at an angle,
/// over 5 degrees, as at a tip on a plate and at corners that meet. `tolerance`: faces no farther apart touch. Looks at
/// pairs of faces near each other, those of a solid with itself only beside a face that it shares with another one.
/// Throws `Error` if OpenCASCADE finds no distance.
std::optional<TangentPoint> find_tangent_point(const TopoDS_Shape& solids, double tolerance);

}  // namespace pamr::geometry
