// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solvers/poisson_boltzmann/fem_domain.hpp"
#include "solvers/poisson_boltzmann/petsc.hpp"

namespace pamr::poisson_boltzmann {

/// The matrix of -lap for P1 elements on all nodes, before any boundary condition: K_ij is the integral of
/// grad phi_i . grad phi_j. Assembled node by node on each rank, rows of shared nodes are added up by PETSc.
/// Collective. O(cells) time; memory: the matrix twice while it is made.
Matrix assemble_stiffness(const par::Comm& comm, const Domain& domain);

}  // namespace pamr::poisson_boltzmann
