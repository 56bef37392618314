// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/io/elements/whole_mesh.hpp"
#include "pamr/io/foam/foam_patches.hpp"

/// Zones of OpenFOAM's cells and faces. Source: OpenFOAM user guide, "Mesh description". Local.
namespace pamr::io::foam {

/// Zones of `cellZones` become regions: N where one is called `region_N`, else the lowest free numbers from 1 on. A cell
/// of two zones stays in the first one. Pre: the cells of `mesh` are those of the case, none is refused. Throws `Error`
/// with file and line.
void read_cell_zones(const std::filesystem::path& folder, WholeMesh& mesh);

/// Zones of `faceZones` become patches of faces inside, those of a patch's name a part of it. Faces of the boundary stay
/// in their patch, with a remark. Pre: `read_patches`. Throws `Error` with file and line.
void read_face_zones(const std::filesystem::path& folder, const CaseFaces& faces, WholeMesh& mesh);

}  // namespace pamr::io::foam
