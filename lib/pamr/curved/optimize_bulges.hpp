// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/curved/bulge_energy.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::curved {

/// How the bulge of an edge may change.
struct Freedom {
  enum class Kind : std::uint8_t { none, along_line, in_plane, any };
  Kind kind = Kind::none;
  geometry::Vec3 direction;  ///< unit vector: of the line, or normal to the plane
};

/// The cells around coarse walls: on each rank its own, and all edges of these.
struct BulgeZone {
  /// Of each cell, in an order that follows from the corners alone (by coordinates, or by global number): ranks,
  /// partition and numbering then do not change a bit of the result. Cells may be left- or right-handed.
  std::vector<geometry::TetPoints> corner;
  std::vector<std::array<LocalId, 6>> cell_to_edge;  ///< edges between these corners as numbered in mesh/tet.hpp
  /// Of each edge, the displacement of its middle, which has no sign: given on walls, start values elsewhere.
  std::vector<geometry::Vec3> bulge;
  std::vector<Freedom> freedom;  ///< of each edge
  /// What walls add to the derivatives of the quadratic map of a cell, for its corners in the order of `corner`.
  SampledWalls walls;
  par::Pattern shared;                ///< edges that other ranks hold too: with the same bulge and freedom
  bool bends_straight_cells = false;  ///< free edges may bend although no wall does
};

/// Bulges that give the cells good shapes.
struct Bulges {
  std::vector<geometry::Vec3> bulge;  ///< of each edge
  int iterations = 0;                 ///< Newton steps
  /// Smallest mean ratio of the Jacobian against the regular tetrahedron at the sample points of all cells, with the
  /// sign of its determinant, for the start values and for the result; 1 without cells.
  double smallest_before = 1, smallest = 1;
};

/// Chooses the free bulges: minimizes the sum over the cells of their `bulge_energy`, by Newton steps with line search,
/// the directions by preconditioned conjugate gradients. The regularization of folded cells falls in stages, then the
/// exponent grows, so that the worst shapes count most. A stage ends when a step changes no cell's energy by more than
/// a tolerance, whatever the size of the zone. Where all bulges and residuals are zero on input they stay so, unless
/// the zone says otherwise: straight walls do not bend the edges around them.
///
/// The result depends on neither order, partition nor ranks: sums over cells are order-free. It is not certified: where
/// `smallest` is not positive, cells are still folded. Throws `Error` on every rank if a cell has no volume or if
/// values are not finite. Collective: two exchanges of edges and two reductions a step of conjugate gradients, some ten
/// of which make a Newton step, some 20 of which make the result. Cost: about 0.1 s and 2 MB a thousand cells.
Bulges optimize_bulges(const par::Comm& comm, const BulgeZone& zone);

}  // namespace pamr::curved
