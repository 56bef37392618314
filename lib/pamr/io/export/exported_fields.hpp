// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/level0_key.hpp"

namespace pamr::io {

/// The fields of a mesh that files of other programs get, in their order: all but those of the map of level 0 and of
/// the patches of inner faces, which no other program could use. They live as long as `all`.
inline std::vector<const mesh::Field*> exported_fields(const std::vector<mesh::Field>& all) {
  std::vector<const mesh::Field*> fields;
  for (const auto& field : all)
    if (!mesh::is_level0_field(field) && !mesh::is_inner_patch_field(field)) fields.push_back(&field);
  return fields;
}

}  // namespace pamr::io
