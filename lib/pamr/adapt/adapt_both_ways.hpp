// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pamr/adapt/adapt.hpp"
#include "pamr/coarsen/coarse_fields.hpp"
#include "pamr/coarsen/settle_octets.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::adapt {

/// What was taken back, and why the rest stayed; counts over all ranks. An octet is eight cells of one regular split,
/// each of which may be replaced by a closure family.
struct CoarseningReport : coarsen::Outcome {
  std::int64_t cells_flagged = 0;           ///< cells with a flag below 0
  std::int64_t cells_without_parent = 0;    ///< of them: level 0, broken families, cells of files of format 1
  std::int64_t cells_without_siblings = 0;  ///< of them: of an octet of which some cell is not flagged, or was split
  std::int64_t cells_moved = 0;             ///< to the rank of their siblings
  std::int64_t cells_between = 0;           ///< cells when all was taken back, before anything was split
};

struct AdaptResult {
  mesh::DistMesh mesh;
  Report report;
  CoarseningReport coarsening;
  /// Cells of the input (by number) that were taken back, each with a cell of the input that has its place: the
  /// `parent` of a cell there, as long as nothing was split. Any rank may hold any of them. What splitting undoes is
  /// not in it: members of a closure family whose parent is split may be nobody's `parent`, as after any refinement.
  std::vector<coarsen::Merged> merged;
};

struct AdaptOptions {
  refine::Options refinement;
  Balancing balancing;  ///< as for `refine`; not looked at where the mesh is not handed over
  /// Cell fields of reals of which splitting and coarsening keep the sum of value times volume, also where walls are
  /// curved; with those of `refinement.integrals`. All others keep values: cells that have one value have it
  /// afterwards. Both are the same where walls are flat.
  std::vector<std::string> integrals{};
};

/// Refines and coarsens once. `flags`, one for each cell of this rank: above 0, the cell is split into eight, as
/// `refine` does; below 0, it may go: with its siblings it becomes their parent again, one level in one call. Refining
/// wins: what splitting or the closure needs stays. Of a closure family all cells have to be flagged. A flag that
/// nothing comes of is no error; the report counts why.
///
/// What results is the closure of the regular splits that remain (docs/coarsening.md). Marks are worked out anew in the
/// whole mesh: a node that nobody needs is gone; without a flag below 0 every node stays, and this is `refine`.
/// Octets that refining reaches stay.
///
/// Collective. Throws `Error` on every rank as `refine` does, and for flags below 0 under another policy than
/// `removable`. The result is valid, and the same mesh on any number of ranks and for any distribution over them.
/// Siblings on several ranks are gathered first, so cells may change their rank here in any case. Memory at the peak:
/// the old mesh, the new one, and about 50 bytes for each old cell.
AdaptResult adapt(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int8_t> flags,
                  const AdaptOptions& options = {});

/// The same, takes the mesh over, and spreads the work as `refine` does.
AdaptResult adapt(const par::Comm& comm, mesh::DistMesh&& mesh, std::span<const std::int8_t> flags,
                  const AdaptOptions& options = {});

struct MeshSize {
  std::int64_t cells = 0, nodes = 0;
};

/// Size of the mesh after `adapt` with 1 for the marked cells and -1 for others that may go: it is done in memory,
/// without fields and surfaces, and thrown away. `mesh` is the same afterwards. Collective.
MeshSize size_after(const par::Comm& comm, mesh::DistMesh& mesh, std::span<const std::uint8_t> marks,
                    std::span<const std::uint8_t> may_go, const refine::Options& refinement = {});

/// Flags for `adapt`: 1 for the marked cells, -1 for others that may go. Local.
std::vector<std::int8_t> signed_flags(std::span<const std::uint8_t> marks, std::span<const std::uint8_t> may_go);

}  // namespace pamr::adapt
