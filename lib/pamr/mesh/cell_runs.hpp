// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

/// Where the ranks hold consecutive runs of cell numbers in rank order: the first number of each rank's run, and the
/// end of the last one; empty where they do not. Much is cheaper for runs: numbers follow from one exclusive sum, and
/// rows lie where a file wants them. Collective: one gather of 8 bytes a rank and
/// one reduction.
std::vector<GlobalId> cell_runs(const par::Comm& comm, const DistMesh& mesh);

}  // namespace pamr::mesh
