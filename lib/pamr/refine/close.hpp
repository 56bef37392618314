// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/carried.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/options.hpp"

namespace pamr::refine {

/// Requests for the cells of a mesh.
struct Wanted {
  std::span<const std::uint8_t> requests;  ///< a `Request` for each cell
  const Carried* carried = nullptr;        ///< what an early pass left known
};

/// Marks every edge that has to be split so that each cell that is asked for becomes eight (of a closure cell under
/// `removable`, its parent) and no hanging node is left: the least fixed point of the rules "these marks, then that
/// mark" (docs/closure.md), the same whatever the order, the partition and the number of ranks.
///
/// Marks live on edges that exist, and
/// so two generations of splits are decided here, before anything is split: of base cells, and of the children of red
/// families. Where a child's marks imply others, which lie on edges that do not exist yet, its family `is_early`, and
/// `Closure::has_early` is set on every rank: then these are to be split first, and what comes of it is to be closed.
/// Families that cannot be taken back are retained, and those that share a cut face with them: before anything is
/// marked, those whose cut face is not one of a whole family on its other side; then, marking again from the start,
/// those that are touched and whose parent would have an inverted child. Collective: k rounds of one neighbor exchange
/// and one reduction. Cost: one ring walk for each marked edge that is not wholly inside flagged cells. Source: ALUGrid
/// and Omega_h do the same with stored edges; least fixed point after R. E. Bank, A. H. Sherman, A. Weiser, "Refinement
/// algorithms and data structures for regular local mesh refinement", 1983 (green closure taken back).
Closure close(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders, const Wanted& wanted,
              const Options& options);

}  // namespace pamr::refine
