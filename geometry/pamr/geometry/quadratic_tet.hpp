// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "pamr/geometry/vec3.hpp"

namespace pamr::geometry {

/// A tetrahedron of second order by its ten nodes: `node[i][i]` is corner i, `node[i][j]` and `node[j][i]` are both the
/// node of the edge between corners i and j. With barycentric coordinates l it is the image of
/// x(l) = sum of l_i (2 l_i - 1) node[i][i] + 4 sum over i < j of l_i l_j node[i][j].
using QuadraticTet = std::array<std::array<Vec3, 4>, 4>;

/// The tetrahedron with straight edges and its nodes in their middles.
QuadraticTet straight_tet(const std::array<Vec3, 4>& corner);

/// What was proved of the Jacobian determinant of a tetrahedron of second order.
struct JacobianBound {
  bool is_proved = false;  ///< it is positive, and not below the limit, everywhere in the cell
  double lower = 0;        ///< no more than its minimum; of use only where `is_proved`
  int n_pieces = 1;        ///< into which the cell was cut to see it
};

/// Tries to prove that the Jacobian determinant of the map from the reference tetrahedron (six volumes where the edges
/// are straight with nodes in the middle) is positive and at least `limit` in all of the tetrahedron. The determinant
/// is a polynomial of degree 3: its 20 Bezier coefficients bound it from below, and those of pieces, made by halving
/// edges, bound it as closely as one likes. All rounding is bounded and counted against the proof; what cannot be
/// decided in 512 pieces counts as not proved. The same bits for the same ten nodes. Cost: about 500 operations where
/// no cut is needed.
/// Sources: A. Johnen, J.-F. Remacle, C. Geuzaine, "Geometrical validity of curvilinear finite elements", J. Comput.
/// Phys. 233 (2013), for the bound by Bezier coefficients and its refinement by subdivision; error analysis as in
/// N. J. Higham, "Accuracy and Stability of Numerical Algorithms" (2002), chapter 3.
JacobianBound bound_jacobian(const QuadraticTet& tet, double limit);

/// A lower bound of a quantity all over a tetrahedron, and a point where the quantity is hardly larger.
struct LowerBound {
  double value = 0;
  std::array<double, 4> near{};  ///< barycentric coordinates
};

/// Lower bounds that hold all over a tetrahedron of second order.
struct MapBounds {
  LowerBound determinant;  ///< of the Jacobian
  /// Mean ratio of the tetrahedron that the Jacobian at a point makes of the reference tetrahedron: what small
  /// tetrahedra of the same shape as this one have there. -1, which always holds, if the determinant is not proved
  /// positive.
  LowerBound mean_ratio;
};

/// Both bounds to one percent of the minimum, or as close as 512 pieces bring them; where the determinant is found not
/// to be positive no closer. By the same coefficients, pieces and bounds of rounding as `bound_jacobian`; the squared
/// size of the Jacobian is convex, so linear functions bound it from above. -infinity and -1 for nodes that are
/// not finite. Cost: some ten microseconds.
MapBounds bound_map(const QuadraticTet& tet);

/// True if the Bezier coefficients of the Jacobian determinant are all positive by exact arithmetic, which proves that
/// the determinant is positive: for cells so flat that rounding hides it. Pre: finite coordinates. Cost: about 1 ms.
bool is_positive_exactly(const QuadraticTet& tet);

/// The image of a point of the reference tetrahedron.
Vec3 point_at(const QuadraticTet& tet, const std::array<double, 4>& barycentric);

/// The Jacobian determinant at a point of the tetrahedron, in plain floating point.
double jacobian_at(const QuadraticTet& tet, const std::array<double, 4>& barycentric);

}  // namespace pamr::geometry
