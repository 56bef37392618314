// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// Exact sign (-1, 0, 1) of the volume (b-a) x (c-a) . (d-a) of a tetrahedron whose corners are the given doubles.
/// A floating-point filter decides nearly all calls; the rest go to CGAL's exact predicate.
int orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d);

/// True when the tetrahedron has positive volume by exact arithmetic.
inline bool is_positive(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return orientation(a, b, c, d) > 0; }

}  // namespace pamr::geometry
