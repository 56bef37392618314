// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/balance/rebalance.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::poisson_boltzmann {

/// The same mesh with about as many cells on every rank and few faces between ranks: each iteration of the solver
/// exchanges the values on them. With `Method::scotch` the cells stay where they are if they are as even and Scotch
/// cuts no fewer faces. Collective.
balance::Rebalanced spread_cells(const par::Comm& comm, mesh::DistMesh mesh, balance::Method method);

}  // namespace pamr::poisson_boltzmann
