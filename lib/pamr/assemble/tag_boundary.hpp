// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pamr/mesh/block_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::assemble {

/// What boundary triangles met; counts over all ranks, the same on every rank.
struct BoundaryMatch {
  /// A triangle that cannot be used: the one with the lowest rank, then the lowest row.
  struct Misfit {
    Rank rank = 0;
    std::int64_t row = 0;
    bool is_on_boundary = false;  ///< it is a face of the boundary that belongs to another patch
  };
  std::int64_t n_untagged = 0;         ///< boundary faces without triangle
  std::int64_t n_not_on_boundary = 0;  ///< triangles that are neither on these nor on a face of the boundary
  std::int64_t n_contradictions = 0;   ///< boundary faces of two patches
  std::vector<std::int64_t> n_inner;   ///< by patch: triangles on the given inner faces
  std::optional<Misfit> first_misfit;
};

/// Gives boundary faces the patches of the triangles on them, and those without triangle the patch `untagged`; without
/// `untagged` the faces have their patches already, and are compared with those of the triangles.
/// - `boundary`: any triangles of the mesh on any rank, in any order; one that is there twice counts once.
/// - `inner_faces`: inner faces on which triangles are counted, not tagged; each on one rank.
/// Collective: two sparse exchanges of the boundary's size, three reductions. Cost: O(cells + boundary log(boundary)).
BoundaryMatch match_boundary(const par::Comm& comm, mesh::DistMesh& mesh, const mesh::BoundaryTriangles& boundary,
                             std::optional<int> untagged, std::span<const mesh::CellFace> inner_faces = {});

/// The same for the triangles of a block. Faces without triangle are put into the patch `boundary`, which is made if
/// there is none. Throws `Error` on every rank, naming the triangle, if one is no face of the boundary or two patches
/// claim a face. Collective.
void tag_boundary(const par::Comm& comm, mesh::DistMesh& mesh, const mesh::BoundaryTriangles& boundary);

/// Throws `Error` on every rank, naming the triangle, unless they agree with the patches that the faces have.
/// Collective.
void compare_boundary(const par::Comm& comm, mesh::DistMesh& mesh, const mesh::BoundaryTriangles& boundary);

}  // namespace pamr::assemble
