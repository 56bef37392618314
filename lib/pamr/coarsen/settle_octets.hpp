// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/coarsen/octets.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/split_pattern.hpp"

namespace pamr::coarsen {

/// Counts over all ranks of what came of the octets all of whose cells may be coarsened.
struct Outcome {
  std::int64_t octets_gone = 0;    ///< coarsened to their parent
  std::int64_t octets_needed = 0;  ///< stay because the closure of what remains or is refined needs them
  std::int64_t octets_kept =
      0;  ///< stay because their parent, closed as it would have to be, had (or were) an inverted cell
  std::int64_t families_closed = 0;  ///< closure families that are closed anew, with fewer marks
  std::int64_t families_kept = 0;    ///< those that stay because a cell would be inverted
  int rounds = 0;                    ///< exchanges with the neighbors to settle this
};

/// The octets that are coarsened, and the nodes that remain.
struct Settled {
  std::vector<Group> groups;             ///< octets that are coarsened and families that are closed anew, ascending
  std::vector<std::uint8_t> node_stays;  ///< n_nodes
  Outcome outcome;
};

/// Reasons that keep octets from being coarsened.
struct Needs {
  /// Of each cell: a family with one above 0 keeps its nodes, because its parent becomes eight.
  std::span<const std::int8_t> flags;
  std::span<const LocalId> nodes;  ///< that stay in any case
  double shape_floor = 0;          ///< see `refine::Options`
};

/// Decides which octets are coarsened. A node stays if it is a corner of a base cell that remains, or if a mark of a
/// base cell that remains lies there. Marks are worked out anew: a base cell has those of its midpoints that stay for
/// others, and what the floor adds to them (rule 4 of docs/closure.md); a parent with six marks, or with one inside
/// its edges or faces, stays split. The least set of nodes that obeys this is unique, whatever the order and the ranks.
///
/// Then each parent and each family that is to be closed anew is looked at: if it would have an inverted cell where the
/// nodes lie, it stays as it is (all of them together), and marks are settled again, until there is none.
///
/// Collective: k rounds of an exchange of a byte for each shared node and a reduction.
/// Cost: one pass over the cells, and per sweep one over the octets and the families beside them.
Settled settle_octets(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                      const std::vector<Group>& octets, const Needs& needs);

}  // namespace pamr::coarsen
