// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/io/written_names.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Writes the folder `constant/polyMesh` of an OpenFOAM case, text: points, faces, owner, neighbour, boundary. Points
/// and cells keep their order; faces between cells come first, by owner (the smaller cell), then by neighbor, as
/// OpenFOAM wants them, then the boundary, patch by patch. Patches keep their names, but for characters that its words
/// cannot have, which become `_`; a patch of kind `wall`, `symmetry` or `symmetryPlane` has that type, others `patch`;
/// the groups of a patch are in `inGroups`.
/// Numbers have as many digits as it takes to read the same ones back. The cells of each region (integer cell field
/// `region`, but 0) become a zone in `cellZones`, named as the region is, or `region_N`. The inner faces of each patch
/// become a zone in `faceZones`, seen from the cell with the lower number. Fields are left out. The same bytes on any
/// number of ranks. A folder `polyMesh` that is there already is replaced when the new one is complete.
///
/// Collective; O(cells / ranks) bytes a rank. Throws the same `Error` on every rank and leaves nothing new behind then;
/// also for two patches that would have the same name. `remark` hears of names that change.
void write_foam(const par::Comm& comm, const std::filesystem::path& case_folder, const mesh::DistMesh& mesh,
                const Remark& remark = {});

/// The folder that it writes: `constant/polyMesh` of the case.
std::filesystem::path foam_folder(const std::filesystem::path& case_folder);

}  // namespace pamr::io
