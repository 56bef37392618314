// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/refine/options.hpp"
#include "pamr/refine/split_pattern.hpp"

namespace pamr::refine {

/// The smallest set of marks that holds `marks` and obeys the policy in a cell that is split by its own pattern: the
/// only place where the policies `none`, `isotropic` and `short_edge` differ. Monotone in `marks`, so the closure of
/// the mesh has one least fixed point whatever the order. Under `removable` it is for cells of no whole family, and any
/// set is legal that is no worse than the shape floor. Local; depends on the cell's lineage and points only.
EdgeMask required_marks(const mesh::DistMesh& mesh, const mesh::Level0View& level0, LocalId cell, EdgeMask marks,
                        const Options& options);

/// Marks of the better of the two faces that hold a short edge of a closure cell: the one whose four children have the
/// larger smallest mean ratio, ties by the coordinates of the face's third corner. 0 when the edge is not short, that
/// is no half of an edge of the parent. Source: the PAMR paper, section 2.1.3 and Fig. 4, written as an implication.
EdgeMask face_implied_by_short_edge(const mesh::DistMesh& mesh, LocalId cell, int edge);

/// How a cell with these marks, which the policy allows, is split by its own pattern; 1:8 with diagonal 0, which is
/// chosen later. 0: not at all.
SplitState state_of_cell(const mesh::DistMesh& mesh, const mesh::Level0View& level0, LocalId cell, EdgeMask marks,
                         const Options& options);

}  // namespace pamr::refine
