// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "pamr/io/elements/whole_mesh.hpp"
#include "pamr/io/foam/foam_patches.hpp"

/// Zones of OpenFOAM's cells and faces. Source: OpenFOAM user guide, "Mesh description". Local.
namespace pamr::io::foam {

/// Zones of `cellZones` become regions: N where one is called `region_N`, else the lowest free numbers from 1 on. A cell
/// of two zones stays in the first one. `first_of_cell`: of each cell of the case its first tetrahedron in `mesh`, and
/// their number at the end. Throws `Error` with file and line.
void read_cell_zones(const std::filesystem::path& folder, const std::vector<std::size_t>& first_of_cell,
                     WholeMesh& mesh);

/// Zones of `faceZones` become patches of faces inside, those of a patch's name a part of it. Faces of the boundary stay
/// in their patch, with a remark. Pre: `read_patches`. Throws `Error` with file and line.
void read_face_zones(const std::filesystem::path& folder, const CaseFaces& faces, WholeMesh& mesh);

}  // namespace pamr::io::foam
