// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Reads the mesh of an OpenFOAM case, `constant/polyMesh` in its folder, of tetrahedra, as text or binary, packed by
/// gzip or not: the patches of `boundary`, with the types wall, symmetry and symmetryPlane as kinds, cyclic
/// ones as periodic and their groups, `cellZones` as the cell field `region` with their names (a cell of two zones
/// stays in the first one), and `faceZones` inside as patches. With `CellOrder::keep` cells and
/// points have the numbers of the case, so that fields of OpenFOAM fit.
///
/// Rank 0 reads the files. Collective. Throws the same `Error` on every rank, with file and line, for what is no such
/// case, and with counts for cells that are no tetrahedra.
ElementMesh read_foam(const par::Comm& comm, const std::filesystem::path& case_folder,
                      const ElementOptions& options = {});

}  // namespace pamr::io
