// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/preconditioner.hpp"

#include <gtest/gtest.h>

#include "solved.hpp"

namespace pamr::poisson_boltzmann {
namespace preconditioner_test {

const std::string plate = cube_boundary("kind = \"symmetry\"", "zmin", "kind = \"potential\"\nvalue = 5");

TEST(Preconditioner, IsChosenBySizeUnlessTheCaseNamesIt) {
  SolverOptions options;
  EXPECT_EQ(choose_preconditioner(options, multigrid_from_nodes - 1), Preconditioner::jacobi);
  EXPECT_EQ(choose_preconditioner(options, multigrid_from_nodes), Preconditioner::boomeramg);
  options.order = 2;
  EXPECT_EQ(choose_preconditioner(options, multigrid_from_nodes), Preconditioner::jacobi);
  options.preconditioner = "boomeramg";
  EXPECT_EQ(choose_preconditioner(options, 1), Preconditioner::boomeramg);
  options.preconditioner = "jacobi";
  EXPECT_EQ(choose_preconditioner(options, multigrid_from_nodes), Preconditioner::jacobi);
}

TEST(Preconditioner, TakesSimilarIterationsOnAnyRanks) {
  par::Comm comm(MPI_COMM_WORLD);
  const Solved jacobi(comm, test::kuhn_cube(comm, 12), "[solver]\npreconditioner = \"jacobi\"\n" + plate);
  const Solved multigrid(comm, test::kuhn_cube(comm, 12), "[solver]\npreconditioner = \"boomeramg\"\n" + plate);

  // One rank takes 178 and 33. Sweeps of multigrid stop at borders of ranks, which parts of 550 nodes feel.
  EXPECT_NEAR(jacobi.solution.linear_iterations, 178, 2);
  EXPECT_NEAR(multigrid.solution.linear_iterations, 33, 2);
  EXPECT_EQ(jacobi.solution.newton_iterations, multigrid.solution.newton_iterations);
}

TEST(Preconditioner, SolvesAgainAfterTheFormsOfTheForceHaveFreedItsHierarchy) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved solved(comm, test::kuhn_cube(comm, 6), "[solver]\npreconditioner = \"boomeramg\"\n" + plate);
  const auto before = solved.solution.u;
  solved.system.harmonic(1U << 4U, 1U << 5U);

  const auto again = solved.system.solve({}, [](const NewtonStep&) {});

  EXPECT_TRUE(again.converged);
  for (std::size_t i = 0; i < again.u.size(); ++i) EXPECT_NEAR(again.u[i], before[i], 1e-8);
}

}  // namespace preconditioner_test
}  // namespace pamr::poisson_boltzmann
