// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/flow/setup.hpp"
#include "solvers/dsmc/run/flow_case.hpp"
#include "solvers/dsmc/run/plan.hpp"

namespace pamr::dsmc {

/// Throws the same `Error` on every rank for a computation that this machine cannot do, before it begins:
/// - more particles than a rank can number, or than fit into the memory that the machines of the ranks have, if the
///   ranks share them evenly: of a domain full of free stream as well as of the gases at the start;
/// - not one particle in a domain full of gas;
/// - a time step in which a fast molecule passes more than 1,000 cells on average, or collides as often, with which
///   nothing would seem to move on.
/// Collective.
void require_feasible(const par::Comm& comm, const Case& the_case, const Setup& setup, const mesh::DistMesh& mesh,
                      const Plan& plan);

}  // namespace pamr::dsmc
