// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "pamr/io/elements/whole_mesh.hpp"
#include "pamr/io/foam/foam_tokens.hpp"

namespace pamr::io::foam {

/// The nodes of each face of a case, and how many faces, the first ones, lie inside.
struct CaseFaces {
  FaceNodes nodes;
  std::int64_t n_inner = 0;
};

/// Adds a face as triangles of that tag: of a quadrangle two, of faces of more corners none.
void add_face(std::span<const std::int64_t> nodes, std::int64_t tag, WholeMesh& mesh);

/// Patches of the file `boundary` with their triangles, kinds and groups (`inGroups`). A patch in groups is in one of its
/// own name as well, unless `write_foam` called it `A+B` after them; the group that OpenFOAM itself gives to a patch, that of
/// its type, says nothing new. Types that are no kinds, and other entries, are left out with a remark. Local. Throws
/// `Error` with file and line. Source: OpenFOAM user guide, "Mesh description".
void read_patches(const std::filesystem::path& folder, const CaseFaces& faces, WholeMesh& mesh);

}  // namespace pamr::io::foam
