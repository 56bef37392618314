// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/settle.hpp"

#include <algorithm>

#include "pamr/base/index.hpp"
#include "pamr/refine/smooth.hpp"
#include "pamr/refine/untangle.hpp"

namespace pamr::refine {

Certificate settle(const par::Comm& comm, mesh::DistMesh& fine, const par::Pattern& shared,
                   const geometry::SurfaceSet& surfaces, const Numbering& numbering, LocalId n_old_nodes,
                   std::vector<Movable> movables, std::span<const LocalId> suspects) {
  int rounds = 0;
  std::vector<LocalId> cells;
  const bool any_moves = comm.any(!movables.empty());
  if (any_moves) {
    const double ratio = smooth_displacement(comm, fine, shared, surfaces, numbering, n_old_nodes, movables);
    for (const auto& m : movables) fine.node_position[at(m.node)] = m.target;
    cells = cells_with_moved_nodes(fine, movables);
    rounds = untangle(comm, fine, shared, surfaces, numbering, n_old_nodes, cells, ratio < gentle_ratio, movables);
    if (rounds > 0) cells = cells_with_moved_nodes(fine, movables);
  }
  auto certificate = certify(comm, fine, shared, surfaces, movables, any_moves, cells, suspects);
  certificate.untangling_rounds = rounds;
  return certificate;
}

}  // namespace pamr::refine
