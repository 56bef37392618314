// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "pamr/adapt/balance_parents.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/certify.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/options.hpp"

namespace pamr::adapt {

/// What one refinement did; counts over all ranks.
struct Report {
  std::int64_t cells_in = 0, cells_out = 0, nodes_in = 0, nodes_out = 0;
  std::int64_t marked_not_split = 0;  ///< cells flagged and not too deep that the result holds unsplit; always 0
  std::int64_t marked_too_deep = 0;   ///< flagged cells that stay, because they have the deepest level (`max_level`)
  refine::ClosureReport closure;
  refine::Certificate certificate;  ///< of the nodes that were put onto surfaces
  BalanceReport balance;            ///< of the overload that may move cells
  /// Ranks that this rank shares nodes with, while closing and after balancing.
  std::int64_t neighbors_closing = 0, neighbors = 0;
  std::vector<StepTime> steps;  ///< of this rank
  Traffic traffic;              ///< of this rank
};

struct RefineResult {
  mesh::DistMesh mesh;
  Report report;
};

/// Refines once: every cell with a nonzero flag is split into eight (under `removable`, a flagged closure cell's parent
/// is), the cells around them are closed, new boundary nodes are put on their surfaces, fields and patches go to the
/// children. Cells stay on the ranks where their parents are; the overload below spreads them.
///
/// `flags`: one for each cell of this rank; those of cells of the deepest level do not count (`limit_depth`).
/// Collective. Throws `Error` on every rank for flags of the wrong length, bad surfaces, cells too flat to be split,
/// and cells of the deepest level that closing the mesh would split. Pre: `mesh` is valid (`validate::validate`). Post:
/// so is the result, and it is the same mesh, cell for cell, node for node, bit for bit, on any number of ranks and for
/// any distribution over them. Memory at the peak: the old mesh, the new one and about 40 bytes for each cell that is
/// split.
RefineResult refine(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags,
                    const refine::Options& options = {});

/// How to refine and balance in one go.
struct Options {
  refine::Options refinement;
  Balancing balancing;  ///< default: PT-Scotch, by the exact number of cells that each cell becomes
};

/// The same, and spreads the work: when the marks are closed and the size of the result is known cell by cell, the
/// parents move to the ranks where their children shall be. Each rank then gets about the same number of cells of the
/// refined mesh, and the splitting is balanced too. The refined mesh is the same one whatever the balancing; only its
/// distribution differs. Takes the mesh over and frees its arrays on the way. Throws `Error` on every rank for bad
/// weights as well. Collective.
RefineResult refine(const par::Comm& comm, mesh::DistMesh&& mesh, std::span<const std::uint8_t> flags,
                    const Options& options = {});

}  // namespace pamr::adapt
