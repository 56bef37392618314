// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "pamr/curved/straighten.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/second_order.hpp"
#include "pamr/par/comm.hpp"

/// Cells of second order, whose boundary follows the surfaces.
namespace pamr::curved {

/// What became of the edges and cells; counts over all ranks, the same on any number of them.
struct Report {
  std::int64_t n_edges = 0;         ///< of the mesh: as many mid-edge nodes
  std::int64_t n_curved_edges = 0;  ///< those whose node is not in the middle
  std::int64_t n_curved_cells = 0;  ///< cells with such an edge
  std::int64_t n_off_surface = 0;   ///< mid-edge nodes of the boundary that are not where they belong
  double max_off_surface = 0;       ///< their largest distance from it, length units
  Straightening straightening;
};

struct CurvedCells {
  mesh::SecondOrder nodes;
  Report report;
};

/// Gives each edge of a mesh a node, which makes its cells cells of second order:
/// - Nodes of edges in the boundary lie on the surface of their patch, on the common curve of two, on sharp edges
///   inside a surface: exactly where a refinement would put them (`refine::project`). Patches that lie in a plane stay
///   flat, described or not. The corners of cells stay where they are.
/// - Those of all other edges lie in the middle; if the mesh has a map of level 0, where that puts them.
/// - Every cell is proved positive: its Jacobian determinant is nowhere below `Options::min_jacobian` of that of the
///   straight cell. Edges of cells of which that is not so are straightened step by step (`straighten`); cells without
///   a curved edge are proved by exact arithmetic where rounding hides their sign.
///
/// Mid-edge nodes are numbered after those of the mesh, in the order of the lowest cell at their edge and then of the
/// edge there: numbers and bits do not depend on the ranks. Throws `Error` on every rank if a cell is so flat that it
/// is inverted by the rounding of the middles of its edges. That all cells are positive does not say that two parts of
/// the boundary cannot run through each other: where a gap is narrower than what its walls bulge, refine first.
/// Collective: as numbering and projecting in a refinement, and one neighbor exchange for each round of straightening.
/// Cost: one walk around each edge, about 1 us a cell for its proof; 100 bytes a cell and 80 an edge until it returns.
CurvedCells curve_cells(const par::Comm& comm, const mesh::DistMesh& mesh, const Options& options = {});

}  // namespace pamr::curved
