// SPDX-License-Identifier: GPL-3.0-or-later
#include <mpi.h>

#include <cstdio>
#include <pamr/par/comm.hpp>
#include <solvers/poisson_boltzmann/fem/petsc.hpp>

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    const pamr::poisson_boltzmann::PetscRuntime petsc(pamr::par::Comm(MPI_COMM_WORLD), "");
    std::printf("PETSc has started, %zu options unused\n", petsc.unused_options().size());
  }
  MPI_Finalize();
}
