// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/coarsening_report.hpp"
#include "pamr/coarsen/coarse_fields.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::adapt {

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

}  // namespace pamr::adapt
