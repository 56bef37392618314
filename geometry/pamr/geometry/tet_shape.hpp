// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

using TetPoints = std::array<Vec3, 4>;

/// Signed volume (p1-p0) x (p2-p0) . (p3-p0) / 6, in cubic length units.
constexpr double volume(const TetPoints& p) { return dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) / 6.0; }

/// Mean of the four corners; the same bits only for the same order of them.
constexpr Vec3 centroid(const TetPoints& p) { return 0.25 * (p[0] + p[1] + p[2] + p[3]); }

/// Mean ratio 12 (3V)^(2/3) / (sum of the six squared edges): 1 for the regular tetrahedron, 0 for a flat one, minus
/// the value of the mirrored cell for an inverted one. Source: A. Liu, B. Joe, BIT 34 (1994).
double mean_ratio(const TetPoints& p);

/// Radius ratio 3 r_in / R_circ, 1 is best, 0 for a flat cell. It and the metrics below do not see inversion.
double radius_ratio(const TetPoints& p);

/// Longest edge / (2 sqrt(6) r_in), 1 is best, infinite for a flat cell.
double aspect_ratio(const TetPoints& p);

/// Longest edge over shortest edge, 1 is best.
double edge_ratio(const TetPoints& p);

/// Smallest and largest of the six dihedral angles, degrees: 70.53 for the regular tetrahedron, 0 and 180 for a sliver
/// without volume.
struct DihedralAngles {
  double min = 0, max = 0;
};
DihedralAngles dihedral_angles(const TetPoints& p);

}  // namespace pamr::geometry
