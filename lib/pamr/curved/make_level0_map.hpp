// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "pamr/curved/coarse_edges.hpp"
#include "pamr/curved/level0_shapes.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/options.hpp"

namespace pamr::curved {

/// What came of making a map of level 0; counts over all ranks, the same on any number of them.
struct Level0Report {
  std::int64_t n_coarse_edges = 0;  ///< `CoarseEdges`
  std::int64_t n_bent_cells = 0;
  std::int64_t n_moved = 0;   ///< nodes of level 0 off their walls that were put onto them first
  double farthest_moved = 0;  ///< how far one of them was off, length unit
  /// Smallest mean ratio of the Jacobian at the sample points, walls included: with straight edges inside, and with the
  /// bulges that were found.
  double smallest_before = 1, smallest = 1;
  int iterations = 0;
  Level0Shapes shapes;  ///< that it makes
  std::string trouble;  ///< why there are coarse edges but no map, or that the map may fold
};

/// Gives a mesh of level 0 with coarse curved walls the map that places new nodes near them (`mesh::Level0Map`), with
/// the fields that cells and nodes need for it, and flat patches their planes. Changes nothing else, and nothing at all
/// where no edge turns out to be coarse and only edges near walls may bend. The same bits on any ranks and for any
/// numbering. Pre: `needs_level0_map`. Source: docs/level0-map.md. Collective. Cost: 0.1 to 0.4 ms a bent cell.
Level0Report make_level0_map(const par::Comm& comm, mesh::DistMesh& mesh, refine::Bend bend = refine::Bend::walls);

}  // namespace pamr::curved
