// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/closure.hpp"

/// How deep a mesh can be refined: a lineage counts no further.
namespace pamr::adapt {

/// Flags of which none asks for more than the deepest level.
struct DepthLimited {
  std::vector<std::uint8_t> flags;
  std::int64_t n_left_out = 0;  ///< flagged cells of this rank that stay because they are as deep as it goes
};

/// Takes the flags from cells whose base cell has the deepest level. `flags`: of each cell of this rank. Local.
DepthLimited limit_depth(const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags);

/// What to tell a user when `n` flagged cells stay.
std::string too_deep_text(std::int64_t n);

/// Whether closing the mesh would split a cell of the deepest level into eight on this rank. Local.
bool is_too_deep(const mesh::DistMesh& mesh, const refine::Closure& closure);

/// Base cells of this level or a deeper one that closing the mesh would split into eight on this rank. Where the marks
/// spare them it is none in meshes that were refined under `removable` alone: marks on edges of one level follow from
/// splits of cells of that level only. Cells of families that were kept or made by another policy have edges of other
/// levels than theirs. Local.
std::int64_t count_splits_from_level(const mesh::DistMesh& mesh, const refine::Closure& closure, Exact<int> level);

/// Throws `Error` on every rank when closing the mesh would split a cell of the deepest level into eight, though it was
/// not flagged itself. Collective: one reduction.
void require_depth(const par::Comm& comm, const mesh::DistMesh& mesh, const refine::Closure& closure);

}  // namespace pamr::adapt
