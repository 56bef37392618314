// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::poisson_boltzmann {

struct Domain;

/// The sides that sheets make of the cells around their nodes: two cells at a node are on one side if a way from one to
/// the other through faces at the node crosses no sheet. The gradient of a potential jumps from side to side, and means
/// over cells are taken on each alone.
struct SheetSides {
  /// n_cells x 4: the corners, but for each node of a sheet an item for its side, n_nodes + k for side k of this rank.
  std::vector<mesh::CellNodes> cell_to_node;
  std::size_t n_sides = 0;
  par::Pattern shared;  ///< of the sides
};

/// Finds them, and which patches have a rim: a node of a sheet with one side only. Leaves `domain` without them where
/// there are no sheets. Collective: a reduction, and where there are sheets some exchanges of shared nodes and faces.
void add_sheet_sides(const par::Comm& comm, Domain& domain);

}  // namespace pamr::poisson_boltzmann
