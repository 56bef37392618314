// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "pamr/mesh/block_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::assemble {

/// What triangles with patches met; counts over all ranks, the same on every rank.
struct BoundaryMatch {
  /// A triangle that cannot be used: the one with the lowest rank, then the lowest row.
  struct Misfit {
    Rank rank = 0;
    std::int64_t row = 0;
    bool is_on_face = false;  ///< it is a face that belongs to another patch
  };
  std::int64_t n_untagged = 0;        ///< boundary faces without triangle
  std::int64_t n_apart = 0;           ///< triangles that are no face of a cell
  std::int64_t n_contradictions = 0;  ///< faces of the boundary of two patches, and faces that had another one
  std::vector<std::int64_t> n_inner;  ///< by patch: faces inside, which have cells on both sides
  /// Faces inside with triangles of two patches, one for each side maybe: they are in the first one.
  std::map<std::pair<int, int>, std::int64_t> in_two_patches;
  std::optional<Misfit> first_misfit;
};

/// Gives faces the patches of the triangles on them, those of the boundary and those inside (`mesh/inner_patches.hpp`),
/// and boundary faces without triangle the patch `untagged`; without `untagged` the boundary has its patches already, and
/// they are compared with those of the triangles.
/// - `triangles`: any triangles of the mesh on any rank, in any order; one that is there twice counts once.
/// Throws `Error` where a patch inside is beyond `mesh::max_inner_patches`. Collective: two sparse exchanges of the
/// boundary's size, three reductions; where triangles lie inside, two exchanges of the nodes' size and two more of theirs.
/// Cost: O(cells + triangles log(triangles)).
BoundaryMatch match_boundary(const par::Comm& comm, mesh::DistMesh& mesh, const mesh::BoundaryTriangles& triangles,
                             std::optional<int> untagged);

/// The same for the triangles of a block. Boundary faces without triangle are put into the patch of kind `untagged`,
/// which is made if there is none. Throws `Error` on every rank, naming the triangle, if one is no face of a cell or
/// two patches claim a face. Collective.
void tag_boundary(const par::Comm& comm, mesh::DistMesh& mesh, const mesh::BoundaryTriangles& triangles);

/// Throws `Error` on every rank, naming the triangle, unless they agree with the patches that the faces have; faces inside
/// that have none get them. Collective.
void compare_boundary(const par::Comm& comm, mesh::DistMesh& mesh, const mesh::BoundaryTriangles& triangles);

}  // namespace pamr::assemble
