// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

/// One broken invariant: its name, how often it is broken over all ranks, and the smallest global cell (node where the
/// name says so) where it is.
struct Violation {
  std::string invariant;
  std::int64_t count = 0;
  GlobalId where = invalid_global;
};

/// Checks every invariant of a mesh by name, all ranks together; an empty list means valid:
/// `ids_in_range`, `cells_ascend`, `finite_coordinates` (where: node), `distinct_corners`, `orientation_positive`
/// (exact predicate), `not_flat` (mean ratio >= 1e-8), `neighbours_reciprocal` (P1, P2: nb(nb(c,f)) = (c,f) with the
/// same three nodes, also across ranks), `patches_in_range`, `families_whole` (contiguous, template order, shared nodes
/// as the template says), `border_matches` (rank-border faces agree on both sides), `shared_nodes_equal` (same
/// coordinates bits on all ranks), `unique_cells`, `boundary_manifold` (each boundary edge in exactly two boundary
/// faces; where: smallest cell), `nodes_referenced`, `fields_sized`. Collective. Cost: O(cells), a few exchanges
/// proportional to the rank border and to the boundary.
std::vector<Violation> validate(const par::Comm& comm, const DistMesh& mesh);

/// Throws `Error` naming the first violation, where it is, and `what`. Collective.
void require_valid(const par::Comm& comm, const DistMesh& mesh, const std::string& what);

}  // namespace pamr::mesh
