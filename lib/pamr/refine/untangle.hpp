// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/diagonal.hpp"
#include "pamr/refine/movable.hpp"
#include "pamr/refine/number.hpp"
#include "pamr/refine/untangle_region.hpp"

namespace pamr::refine {

/// How good a cell is, for untangling: `shape` (see diagonal.hpp) where it has volume; below zero the volume over the
/// cube of its size, so that shrinking an inverted cell to nothing or blowing it up is no way out.
double untangle_key(const geometry::TetPoints& p);

/// The same of a closure family: of the worst child, were its parent split into eight by the best diagonal. Below zero
/// the family could not be taken back at the next level.
double untangle_key(const SplitPoints& parent);

/// Mean ratio under which a cell at a moved node is worth the effort; the same on a gently curved wall, where it must
/// also have lost by the movement; under which nodes of the wall move along it; which the children of a family's parent
/// should have.
inline constexpr double poor_mean_ratio = 0.2, very_poor_mean_ratio = 0.05, sliding_mean_ratio = 0.005,
                        parent_mean_ratio = 0.1;
/// How far a node of the wall may move along it, in parts of its shortest edge, and of its longest one
/// while a cell at it is turned over and nothing else helps.
inline constexpr double longest_slide = 0.2;

/// Moves new nodes near bad cells to where the worst cell at each of them is better: inner nodes anywhere; where they
/// alone do not do, nodes of the wall along their surfaces too, which spoils the shape of the wall's faces. `fine` has
/// the nodes of `movables` at their targets; afterwards they lie where they are best, and `movables` say so (inner
/// nodes that moved are added). Each round takes nodes that have no cell in common (by a hash of their coordinates),
/// tries places round each and keeps the one whose worst cell is best, if better than before: the worst cell at any
/// node never gets worse. Nothing to do without a cell of `cells` that is poor (`is_gentle`: turned over, or very poor
/// because of the movement) or a closure family with such a parent. Returns the number of rounds. Collective: one
/// reduction, and with work to do three exchanges and a reduction a round. Depends on neither order, numbering nor
/// ranks. Source of the idea (foldover-free, worst first): L. Freitag, P. Plassmann, Local optimization-based
/// simplicial mesh untangling and improvement, Int. J. Numer. Meth. Engng 49 (2000).
int untangle(const par::Comm& comm, mesh::DistMesh& fine, const par::Pattern& shared,
             const geometry::SurfaceSet& surfaces, const Numbering& numbering, LocalId n_old_nodes,
             const std::vector<LocalId>& cells, bool is_gentle, std::vector<Movable>& movables);

}  // namespace pamr::refine
