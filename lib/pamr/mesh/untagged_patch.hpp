// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

/// Kind of the patch that holds the boundary faces without a tag. It tells this patch from one that a user calls
/// `boundary`, and goes with the mesh into native files; formats that allow faces without a tag get them without one.
inline constexpr const char* untagged_kind = "untagged";

inline bool is_untagged(const Patch& patch) { return patch.kind == untagged_kind; }

/// The index of the patch for boundary faces without a tag, the number of patches if there is none. Local.
std::size_t find_untagged(const std::vector<Patch>& patches);

/// Boundary faces of the patch of this index, which need not be there yet. Collective: one reduction.
std::int64_t count_faces_of(const par::Comm& comm, const DistMesh& mesh, int patch);

/// Boundary faces without a tag. Collective: likewise.
std::int64_t count_untagged_faces(const par::Comm& comm, const DistMesh& mesh);

/// A patch for boundary faces without a tag beside others: `boundary`, or `boundary_2`, ... where that is taken. Local.
Patch untagged_patch(const std::vector<Patch>& others);

}  // namespace pamr::mesh
