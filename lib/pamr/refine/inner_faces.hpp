// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "pamr/mesh/field.hpp"
#include "pamr/refine/number.hpp"
#include "pamr/refine/split_pattern.hpp"
#include "pamr/refine/subdivide.hpp"

namespace pamr::refine {

/// The patches of the inner faces (`mesh::inner_patch_field`) of the children of a cell that is split by a pattern: parts
/// of a face have its patch, faces between the children have none.
std::array<std::int64_t, max_children> inner_patches_of_children(std::int64_t parent, const SplitPattern& pattern);

/// The field of the refined mesh; none if the old mesh has none. A parent that is split anew has the patches that the
/// members of its family show on its faces. Both sides of a face do the same, so nothing is exchanged. Local.
/// Cost: O(cells + children).
std::optional<mesh::CellField> inner_patches_of_children(const NumberedMesh& old, const Children& children);

}  // namespace pamr::refine
