// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/flow/setup.hpp"
#include "solvers/dsmc/run/flow_case.hpp"

namespace pamr::dsmc {

/// The case on a mesh. Throws `Error` for patches without a condition, conditions without a patch, and a length unit
/// that is not known in meters. `fnum`: F_num, where a run goes on that computed it for another mesh; none: as the case
/// says. Collective: one reduction.
Setup make_setup(const par::Comm& comm, const Case& the_case, const mesh::DistMesh& mesh,
                 std::optional<double> fnum = {});

/// `Setup::cell_dt` alone: all that changes in a setup when cells move to other ranks. `unit`: meters in the mesh's
/// length unit. Local.
std::vector<double> make_cell_dt(const Case& the_case, const mesh::DistMesh& mesh, double unit);

/// Throws the same `Error` on every rank if a region of the case fills no cell at the start, because it holds no
/// centroid of a cell or because later regions fill all of its cells. Collective: one reduction for regions that fill
/// cells.
void require_regions(const par::Comm& comm, const Case& the_case, const Setup& setup, const mesh::DistMesh& mesh);

}  // namespace pamr::dsmc
