// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::refine {

/// A new face of this rank whose other side lies on another rank.
struct BorderFace {
  mesh::CellFace face;
  LocalId old_face = 0;  ///< the rank-border face of the old mesh that it is part of
};

/// Fills the rank-border arrays of `fine` and the ghost slots of its cells: each rank tells its neighbors the cell
/// behind each new border face. Both sides list them by the old border faces that they are part of, whose order they
/// share, and the parts of one by their nodes, so nothing is searched. `old_face`: the same one on both sides; the
/// lowest where a face is part of several, as where a halved face is split anew. Collective: one sparse exchange of 16
/// bytes a face; time and memory proportional to the rank border.
void link_border(const par::Comm& comm, const mesh::DistMesh& old, const std::vector<BorderFace>& faces,
                 mesh::DistMesh& fine);

}  // namespace pamr::refine
