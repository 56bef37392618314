// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/locate/cell_tree.hpp"
#include "pamr/locate/walk.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::locate {

/// For each point of this rank the number of cells of all ranks that hold it, inside or on their surface, by exact
/// predicates: 1 strictly inside a cell of a mesh that does not overlap itself. `tree`: of this rank's part of the
/// mesh. The same on any number of ranks. Collective: a gather of six numbers a rank and two sparse exchanges.
std::vector<std::int64_t> count_cells(const par::Comm& comm, const mesh::DistMesh& mesh, const CellTree& tree,
                                      std::span<const geometry::Vec3> points);

}  // namespace pamr::locate
