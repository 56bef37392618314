// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// Unit normal at `origin` of the quadric height field z = d x + e y + a x^2 + b x y + c y^2 over the plane with normal
/// `guess` (a unit vector) through `origin` that fits the points best, near points counting more. What the points do
/// not determine is left at zero, so that points of the plane itself give `guess` back. Second order in the distance of
/// the points. Local; O(n).
/// Source: F. Cazals, M. Pouget, Estimating differential quantities using polynomial fitting of osculating jets, 2005.
Vec3 jet_normal(Vec3 origin, Vec3 guess, std::span<const Vec3> points);

}  // namespace pamr::geometry
