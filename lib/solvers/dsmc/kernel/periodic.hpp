// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/kernel/boundary.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"

namespace pamr::dsmc {

/// Joins the faces of periodic patches: `across` and `shift` of `domain` are filled, and faces whose partner lies on
/// another rank become faces of a border with it, after those of the mesh. The shift of a patch is found from the
/// patches: middle to middle, then to the last bit from a corner. Shifted by it each face must be one of the partner's,
/// seen from the other side, to a millionth of its size; else throws `Error` that names the first that is not.
/// Collective: three sparse exchanges. O(periodic faces log) time and memory on rank 0.
void join_periodic(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const BoundaryCondition> patch,
                   GasDomain& domain);

}  // namespace pamr::dsmc
