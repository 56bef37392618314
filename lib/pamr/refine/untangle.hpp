// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/geometry/tet_shape.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/diagonal.hpp"
#include "pamr/refine/movable.hpp"
#include "pamr/refine/new_level.hpp"

namespace pamr::refine {

/// Quality of a cell, for untangling; the larger, the better. A cell of positive volume has its `shape` (diagonal.hpp).
/// An inverted one has its volume over the cube of its size: neither shrinking it nor enlarging it changes that.
double untangle_key(const geometry::TetPoints& p);

/// Quality of a closure family: that of the worst child when its parent is split into eight along the best diagonal.
/// Below zero the family cannot be taken back at the next level.
double untangle_key(const SplitPoints& parent);

/// A cell at a moved node is worked on below this mean ratio.
inline constexpr double poor_mean_ratio = 0.2;
/// The same on a gently curved wall, if the cell was better before the movement.
inline constexpr double very_poor_mean_ratio = 0.05;
/// Nodes of the wall slide along it for cells below this mean ratio.
inline constexpr double sliding_mean_ratio = 0.005;
/// Mean ratio that the children of a family's parent should have.
inline constexpr double parent_mean_ratio = 0.1;
/// How far a node of the wall may slide, in parts of its shortest edge; of its longest edge while a cell at it is
/// inverted and nothing else helps.
inline constexpr double longest_slide = 0.2;

/// The movement as it is after untangling.
struct Untangled {
  Movement movement;
  int rounds = 0;
  bool reaches_open = false;  ///< nodes beyond the level's open nodes would move too
};

/// Moves new nodes near bad cells to where the worst cell at each of them is better: inner nodes anywhere; where that
/// is not enough, nodes of the wall along their surfaces too, which spoils the shape of the wall's faces.
///
/// `position`: of every node of the level, those of `movement` at their targets. The result has the targets that are
/// best, and the other inner nodes that moved.
/// A round takes nodes that have no cell in common (by a hash of their coordinates), tries places around each and keeps
/// the one whose worst cell is best, if better than before: the worst cell at any node never gets worse.
/// There is nothing to do unless a cell of `movement` is poor (`is_gentle`: inverted, or very poor because of the
/// movement) or belongs to a closure family with such a parent. Depends on neither order, numbering nor ranks.
/// Collective: one reduction, and with work to do three exchanges and a reduction a round.
/// Source of the idea (foldover-free, worst first): L. Freitag, P. Plassmann, Local optimization-based simplicial mesh
/// untangling and improvement, Int. J. Numer. Meth. Engng 49 (2000).
Untangled untangle(const par::Comm& comm, const NewLevel& level, const std::vector<geometry::Vec3>& position,
                   Movement movement, bool is_gentle);

}  // namespace pamr::refine
