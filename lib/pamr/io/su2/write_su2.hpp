// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/io/written_names.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Writes tetrahedra, nodes and boundary triangles in SU2's format, in global order, with as many digits as it takes to
/// read the same numbers back; patches with faces become markers of their names, with `_` for blanks. Fields, regions and
/// kinds have no place in it. `remark` hears of names that change. The same bytes on any number of ranks. Collective;
/// throws the same `Error` on every rank, also
/// for two patches that would have one name, and leaves nothing behind then.
void write_su2(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
               const Remark& remark = {});

}  // namespace pamr::io
