// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/subdivide.hpp"

namespace pamr::refine {

/// A new face of this rank whose other side lies on another rank.
struct BorderFace {
  mesh::CellFace face;
  LocalId old_face = 0;  ///< the rank-border face of the old mesh that it is part of
};

/// The rank-border faces of the refined mesh; the arrays of the same names of `mesh::DistMesh`.
struct BorderLinks {
  std::vector<Rank> border_rank;
  std::vector<std::size_t> border_offset;
  std::vector<mesh::CellFace> border_face;
  std::vector<GlobalId> ghost_global;
};

/// Puts the new border faces in order and finds the cells behind them: each rank tells its neighbors the cell behind
/// each face. Both sides list them by the old border faces that they are part of, whose order they share, and the parts
/// of one by their nodes, so nothing is searched.
///
/// `faces[i].old_face`: the same one on both sides; the lowest if a face is part of several, as when a halved face is
/// split anew. `node_global`: of every node of the refined mesh.
/// Collective: one sparse exchange of 16 bytes a face; time and memory proportional to the rank border.
BorderLinks link_border(const par::Comm& comm, const mesh::DistMesh& old, const std::vector<BorderFace>& faces,
                        const Children& children, const std::vector<GlobalId>& node_global);

}  // namespace pamr::refine
