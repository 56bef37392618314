// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/base/types.hpp"
#include "solvers/poisson_boltzmann/fem/petsc.hpp"
#include "solvers/poisson_boltzmann/problem/pb_case.hpp"

namespace pamr::poisson_boltzmann {

enum class Preconditioner { jacobi, boomeramg };

/// Elements of first order with at least so many nodes are solved with multigrid unless the case says otherwise.
/// Measured (docs/reports/poisson-boltzmann-speed.md): the two take the same time there, and Jacobi's iterations grow
/// with the cube root.
inline constexpr GlobalId multigrid_from_nodes = 40'000;

/// The one that the case names, or that fits the size: `n_nodes` of the whole mesh.
Preconditioner choose_preconditioner(const SolverOptions& options, GlobalId n_nodes);
/// Its name in case files and reports.
const char* name_of(Preconditioner preconditioner);

/// Sets it, to be changed by the user's options afterwards. Multigrid is hypre's with settings for tetrahedra: one
/// level of aggressive coarsening, short interpolation, a sweep forward and one backward. Collective.
void set_preconditioner(KSP solver, Preconditioner preconditioner);

/// To be called once the user's options are set: additive Schwarz becomes the symmetric kind, since conjugate gradients
/// need one; PETSc's default is not, and may not converge. Throws `Error` for the one that crashes, tfs. Collective.
void keep_symmetric(KSP solver);

/// Newton's steps change the diagonal alone, most of it in few places, so that one multigrid hierarchy serves all
/// steps: tells PETSc so if the solver still has that preconditioner and the user has no wish. Collective.
void keep_hierarchy(SNES newton);
/// To be called before a step's preconditioner: asks for a new hierarchy if the last step took many iterations.
void renew_hierarchy_if_slow(SNES newton);

}  // namespace pamr::poisson_boltzmann
