// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/refine/options.hpp"
#include "pamr/refine/split_pattern.hpp"

namespace pamr::refine {

/// The smallest set of marks that holds `marks`, is legal and obeys the policy in a cell that is split by its own
/// pattern: the only place where the policies `none`, `isotropic` and `short_edge` differ. Monotone in `marks`, so the
/// closure of the mesh has one least fixed point whatever the order. Under `removable` it holds for regular cells
/// (which become eight where `closes_badly`) and for families that keep their closure. Local; depends on the cell's
/// lineage and points only.
EdgeMask required_marks(const mesh::DistMesh& mesh, LocalId cell, EdgeMask marks, QualityControl policy);

/// True when a cell should rather become eight than be closed with these legal marks (1:2 or 1:4): when closing one of
/// the marked edges, or the marked face, would make a cell of mean ratio under `worst_closure`, and 1:8 would not
/// make one as poor. New nodes are taken in the middle of their edges. Because one bad edge is enough, whatever else is
/// marked, the rule is monotone. Used by `removable`, on regular cells and rebuilt parents.
bool closes_badly(const geometry::TetPoints& corner, EdgeMask marks);
inline constexpr double worst_closure = 0.3;

/// Marks of the better of the two faces that hold a short edge of a closure cell: the one whose four children have the
/// larger smallest mean ratio, ties by the coordinates of the face's third corner. 0 when the edge is not short, that
/// is no half of an edge of the parent. Source: the PAMR paper, section 2.1.3 and Fig. 4, written as an implication.
EdgeMask face_implied_by_short_edge(const mesh::DistMesh& mesh, LocalId cell, int edge);

}  // namespace pamr::refine
