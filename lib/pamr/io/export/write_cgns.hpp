// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/io/written_names.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Writes a mesh with its fields as a CGNS file (on HDF5), in global order: one base, one unstructured zone, the cells
/// as elements TETRA_4, the boundary triangles (outward) of each patch as elements TRI_3 of its name with a boundary
/// condition of its name on them; patches inside alone, and what of others lies inside, are such elements without a
/// condition. Kinds of patches are `wall` (BCWall), `symmetry` and `symmetryPlane`
/// (BCSymmetryPlane), `farfield`, `inflow`, `outflow`; others have the condition UserDefined. Fields are flow
/// solutions at vertices and at cell centers, with a name for each component: vectors get X, Y, Z, others _1, _2, ...
/// Names are cut to the format's 32 characters; `remark` hears of patches whose names change. Numbers have 32 bits where these suffice, else 64.
///
/// Written by the layout that CGNS defines on HDF5, without the library of CGNS: its HDF5 and ours could not live in
/// one process, and every rank writes its own rows. The same bytes on any number of ranks. Collective; throws the same
/// `Error` on every rank, also where cut names are no longer different, and leaves nothing behind then.
void write_cgns(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                const Remark& remark = {});

}  // namespace pamr::io
