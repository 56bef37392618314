// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/flow/flow.hpp"

namespace pamr::dsmc {

/// A mesh of which the cells at walls are split, and what its cells have from those they come of.
struct SplitWalls {
  mesh::DistMesh mesh;                        ///< with the field `parent`
  std::int64_t n_split = 0;                   ///< cells at walls, of all ranks
  std::vector<std::uint8_t> is_at_wall;       ///< of the cells before: whether it was one of them
  std::vector<std::uint8_t> comes_from_wall;  ///< of the cells now: whether they are of such a cell
  std::vector<double> cell_dt;                ///< s, as `Setup::cell_dt`: time steps are those of the cells before
};

/// Splits every cell with a face on a wall into eight and closes the mesh around them. New nodes are the midpoints of
/// edges, so that every cell lies in the one it comes of and the walls stay as flat as they were. Cells stay on their
/// ranks, or go to where their siblings are. `mesh`: that of the flow. Collective.
SplitWalls split_walls(const par::Comm& comm, const mesh::DistMesh& mesh, const Flow& flow);

}  // namespace pamr::dsmc
