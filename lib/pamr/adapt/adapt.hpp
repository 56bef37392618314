// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/adapt/balance_parents.hpp"
#include "pamr/adapt/coarsening_report.hpp"
#include "pamr/adapt/given_mesh.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/coarsen/coarse_fields.hpp"
#include "pamr/curved/make_level0_map.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/certify.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/options.hpp"

namespace pamr::adapt {

/// What one call did; counts over all ranks.
struct Report {
  std::int64_t cells_in = 0, cells_out = 0, nodes_in = 0, nodes_out = 0;
  std::int64_t marked_not_split = 0;  ///< cells flagged and not too deep that the result holds unsplit; always 0
  std::int64_t marked_too_deep = 0;   ///< flagged cells that stay, because they have the deepest level (`max_level`)
  curved::Level0Report level0;        ///< of the map that was made for coarse walls, if one was
  /// Share of cells that the default shape floor adds to those of `lower_floor`, about, if asked for.
  double floor_cost = 0, lower_floor = 0;
  refine::ClosureReport closure;
  refine::Certificate certificate;  ///< of the nodes that were put onto surfaces
  BalanceReport balance;            ///< where the mesh was handed over, so that cells may move
  /// Ranks that this rank shares nodes with, while closing and after balancing.
  std::int64_t neighbors_closing = 0, neighbors = 0;
  std::vector<StepTime> steps;  ///< of this rank
  Traffic traffic;              ///< of this rank
};

/// How to adapt.
struct Options {
  refine::Options refinement;
  /// By default PT-Scotch, by the exact number of cells that each cell becomes. Not looked at where the mesh is lent.
  Balancing balancing;
  bool compares_floors = false;  ///< fill `Report::floor_cost`, which takes up to a quarter of the time
};

struct Result {
  mesh::DistMesh mesh;
  Report report;
  CoarseningReport coarsening;
  /// Coarsened cells of the input (by number), each with a cell of the input that has its place: the
  /// `parent` of a cell there, as long as nothing was split. Any rank may hold any of them. What splitting undoes is
  /// not in it: members of a closure family whose parent is split may be nobody's `parent`, as after any refinement.
  std::vector<coarsen::Merged> merged;
};

/// Refines and coarsens once. `flags`, one for each cell of this rank: above 0, the cell is split into eight (under
/// `removable`, a flagged closure cell's parent is), the cells around it are closed, new boundary nodes are put on
/// their surfaces, fields and patches go to the children; below 0, it may be coarsened: with its siblings it becomes
/// their parent again, one level in one call. Refining wins: what splitting or the closure needs stays. Of a closure
/// family all cells have to be flagged. A flag that nothing comes of is no error; the report counts why. Flags above 0
/// of cells of the deepest level do not count (`limit_depth`).
///
/// What results is the closure of the regular splits that remain (docs/coarsening.md). Marks are worked out anew in the
/// whole mesh: a node that nobody needs is gone; without a flag below 0 every node stays. Octets that refining reaches
/// stay.
///
/// A mesh that is handed over is freed on the way, and the work is spread: when the marks are closed and the size of
/// the result is known cell by cell, the parents move to the ranks where their children shall be. Each rank then gets
/// about the same number of cells of the result, and the splitting is balanced too. Of a mesh that is lent, cells stay
/// on the ranks where their parents are; siblings on several ranks are gathered first in any case.
///
/// Collective. Throws `Error` on every rank for flags of the wrong length, flags below 0 under another policy than
/// `removable`, bad options, weights and surfaces, cells too flat to be split, and cells of the deepest level that
/// closing the mesh would split. Pre: `mesh` is valid (`validate::validate`). Post: so is the result, and it is the
/// same mesh, cell for cell, node for node, bit for bit, on any number of ranks, for any distribution over them and
/// whatever the balancing. Memory at the peak: the old mesh, the new one, and about 40 bytes for each cell that is
/// split, or 50 for each old cell where cells may be coarsened.
Result adapt(const par::Comm& comm, GivenMesh mesh, std::span<const std::int8_t> flags, const Options& options = {});

struct ReadyMesh;

/// `adapt` of a mesh that was handed to `with_level0_map`, whose report the caller wants first. Collective.
Result adapt_ready(const par::Comm& comm, ReadyMesh ready, std::span<const std::int8_t> flags,
                   const Options& options = {});

/// `adapt` where no cell may be coarsened: every cell with a nonzero flag is split. Collective.
Result refine(const par::Comm& comm, GivenMesh mesh, std::span<const std::uint8_t> flags,
              const refine::Options& refinement = {}, const Balancing& balancing = {});

}  // namespace pamr::adapt
