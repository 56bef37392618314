// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::validate {

/// One broken invariant: its name, how often it is broken over all ranks, and the smallest global cell (node where the
/// name says so) where it is, if there is one: `ids_in_range`, `fields_sized`, `inner_patches_agree` and two patches of
/// kind `untagged` may have none.
struct Violation {
  std::string invariant;
  std::int64_t count = 0;
  GlobalId where = invalid_global;
};

/// Checks every invariant of a mesh by name, all ranks together; an empty list means valid. In order of report:
///
/// | name                    | means                                                                                  |
/// |-------------------------|----------------------------------------------------------------------------------------|
/// | `ids_in_range`          | arrays of equal length, node, cell, ghost and face numbers that exist                  |
/// | `cells_ascend`          | a rank's cells ascend in global number                                                 |
/// | `unique_cells`          | every global cell number occurs on exactly one rank, once                              |
/// | `distinct_corners`      | four different nodes a cell                                                            |
/// | `fields_sized`          | values of a field: elements times components                                           |
/// | `finite_coordinates`    | (where: node) no coordinate of 1e30 or more, no NaN                                    |
/// | `orientation_positive`  | (p1-p0) x (p2-p0) . (p3-p0) > 0 by exact arithmetic                                    |
/// | `not_flat`              | mean ratio of at least 1e-8                                                            |
/// | `patches_in_range`      | boundary and inner faces name patches that exist                                       |
/// | `inner_patches_agree`   | both cells at an inner face name the same patch for it                                  |
/// | `untagged_outside`      | at most one patch of kind `untagged`, which has no faces inside                        |
/// | `neighbors_reciprocal` | a neighbor names the cell in turn, across the same nodes, and lies on their other side
/// | | `conforming`            | a face is in one cell, with a patch, or in two that name each other: no hanging node |
/// | `border_matches`        | both ranks list the same rank-border faces in the same order                           |
/// | `families_whole`        | closure families: contiguous, in template order, nodes shared as the template says     |
/// | `unique_nodes`          | (where: node) a rank holds a global node once                                          |
/// | `shared_nodes_equal`    | (where: node) the same coordinate bits on all ranks that hold it                       |
/// | `nodes_referenced`      | (where: node) every global node is a corner of a cell, every node held is used here    |
/// | `boundary_manifold`     | every boundary edge lies in exactly two boundary faces                                 |
///
/// Where `ids_in_range` or `distinct_corners` is broken the checks that follow numbers are left out. Cells round one
/// edge are found by walks through the neighbors elsewhere; meshes that pass here cannot lead such a walk astray.
/// Collective. Cost: O(cells log(faces at a node)) time, 16 bytes a cell of memory in addition to the mesh; exchanges
/// of 16 bytes a node, and proportional to the rank border and to the boundary.
std::vector<Violation> validate(const par::Comm& comm, const mesh::DistMesh& mesh);

/// ", first at cell 5", or a node; empty for one without a place.
std::string text_of_place(const Violation& violation);

/// Throws `Error` naming `what` for a mesh smaller than `geometry::min_extent`, so that measures of shapes underflow.
/// Collective.
void require_size(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& what);

/// Throws `Error` naming the first violation, where it is (of `untagged_outside` the patches), and `what`, the same on
/// every rank; as `require_size` where there is none. Collective.
void require_valid(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& what);

/// Throws `Error` naming `what`, the same on every rank, for a mesh that breaks `finite_coordinates`,
/// `orientation_positive` or `not_flat`: what splitting the cells of a valid mesh may come to (slivers, edges whose
/// volumes are too small for a double). Pre: the other invariants hold. Collective, one reduction where all are good.
void require_shapes(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& what);

}  // namespace pamr::validate
