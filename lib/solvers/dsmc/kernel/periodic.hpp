// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/kernel/boundary.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"

namespace pamr::dsmc {

/// Connects the faces of periodic patches: fills `across` and `shift` of `domain`; faces whose partner is on another
/// rank become faces of a border with it, after those of the mesh.
///
/// The shift of a patch is computed from the patches: from center to center, then to the last bit from a corner. Each
/// face, shifted, must coincide with one of the partner patch, seen from the other side, to a millionth of its size.
/// Throws `Error` that names the first face that does not. Collective: three sparse exchanges. O(periodic faces log)
/// time and memory on rank 0.
void join_periodic(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const BoundaryCondition> patch,
                   GasDomain& domain);

}  // namespace pamr::dsmc
