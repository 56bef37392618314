// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/solve.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "solved.hpp"

namespace pamr::poisson_boltzmann {
namespace solve_test {

const std::string mirrors = "kind = \"symmetry\"";
std::string potential(double value) { return "kind = \"potential\"\nvalue = " + std::to_string(value); }

struct Errors {
  double l2, h1;
};
Errors manufactured_errors(const par::Comm& comm, int n, const std::string& solver) {
  Solved solved(comm, test::kuhn_cube(comm, n),
                "[equation]\nmanufactured = true\n" + solver + cube_boundary("kind = \"manufactured\""));
  const auto analysis = solved.analysis(comm);
  return {*analysis.manufactured_l2, *analysis.manufactured_h1};
}

TEST(Solve, ConvergesWithTheOrdersOfLinearElements) {
  par::Comm comm(MPI_COMM_WORLD);
  for (const std::string quadrature : {"nodal", "gauss"}) {
    const std::string solver = "[solver]\nquadrature = \"" + quadrature + "\"\n";
    const auto coarse = manufactured_errors(comm, 5, solver), fine = manufactured_errors(comm, 10, solver);

    EXPECT_NEAR(std::log2(coarse.l2 / fine.l2), 2, 0.1) << quadrature;
    EXPECT_NEAR(std::log2(coarse.h1 / fine.h1), 1, 0.1) << quadrature;
  }
}

TEST(Solve, ConvergesOnAMeshWithoutOrder) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved solved(comm, test::random_mesh(comm, 7, 4),
                "[equation]\nmanufactured = true\n" + cube_boundary("kind = \"manufactured\""));

  EXPECT_TRUE(solved.solution.converged);
  EXPECT_LT(*solved.analysis(comm).manufactured_l2, 0.02);
}

TEST(Solve, GivesTheSameChargeAndEnergyOnAnyNumberOfRanks) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved solved(comm, test::kuhn_cube(comm, 6), cube_boundary(mirrors, "zmin", potential(5)));
  const auto analysis = solved.analysis(comm);

  // What one rank gives.
  EXPECT_NEAR(analysis.patches[4].charge.value(), 13.9503076365, 1e-7);
  EXPECT_NEAR(analysis.energy.value().total, 20.6144970620, 1e-7);
  EXPECT_EQ(solved.solution.newton_iterations, 6);
}

TEST(Solve, ScalesALinearEquationWithItsData) {
  par::Comm comm(MPI_COMM_WORLD);
  for (const std::string order : {"1", "2"}) {
    const auto solved_with = [&](double value) {
      return std::make_unique<Solved>(
          comm, test::kuhn_cube(comm, 3),
          fmt::format(
              "[equation]\nlinear = true\n[solver]\norder = {}\n[estimator]\ngoals = [\"force-z\", \"energy\"]\n"
              "goal_patch = \"zmin\"\n[boundary]\nzmin = {{ kind = \"potential\", value = {} }}\n"
              "zmax = {{ kind = \"charge\", value = {} }}\n\"*\" = {{ kind = \"symmetry\" }}\n",
              order, value, -2 * value));
    };
    const auto of_one = solved_with(1);
    const auto goals_of_one = of_one->analysis(comm).goals;

    for (const double value : {1e-50, 1e-9, 1e9, -1e49}) {
      const auto scaled = solved_with(value);
      ASSERT_TRUE(scaled->solution.converged) << scaled->solution.reason;
      for (std::size_t i = 0; i < scaled->solution.u.size(); ++i)
        ASSERT_NEAR(scaled->solution.u[i] / value, of_one->solution.u[i], 1e-9) << value;
      const auto goals = scaled->analysis(comm).goals;
      for (std::size_t g = 0; g < goals.size(); ++g) {
        EXPECT_NEAR((*goals[g].value + goals[g].correction) / value / value,
                    *goals_of_one[g].value + goals_of_one[g].correction, 1e-9)
            << value;
        ASSERT_EQ(goals[g].error_bar.has_value(), goals_of_one[g].error_bar.has_value());
        if (!goals[g].error_bar) continue;
        EXPECT_NEAR(*goals[g].error_bar / value / value, *goals_of_one[g].error_bar, 1e-9) << value;
      }
    }
  }
}

TEST(Solve, AnswersZeroDataWithZero) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved solved(comm, test::kuhn_cube(comm, 3), cube_boundary(potential(0)));

  EXPECT_TRUE(solved.solution.converged);
  EXPECT_TRUE(std::all_of(solved.solution.u.begin(), solved.solution.u.end(), [](double u) { return u == 0; }));
}

TEST(Solve, ChangesSignWithItsData) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved plus(comm, test::kuhn_cube(comm, 4), cube_boundary(mirrors, "xmax", potential(3)));
  Solved minus(comm, test::kuhn_cube(comm, 4), cube_boundary(mirrors, "xmax", potential(-3)));

  for (std::size_t i = 0; i < plus.solution.u.size(); ++i) ASSERT_NEAR(plus.solution.u[i], -minus.solution.u[i], 1e-9);
}

TEST(Solve, KeepsTheMaximumPrincipleWhereNoAngleIsObtuse) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved solved(comm, test::kuhn_cube(comm, 5), cube_boundary(mirrors, "zmin", potential(8)));
  for (const double u : solved.solution.u) {
    ASSERT_GE(u, 0);
    ASSERT_LE(u, 8);
  }
}

TEST(Solve, FindsNothingBesideThePlateProfileWhenItIsSplitOff) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved solved(comm, test::kuhn_cube(comm, 4),
                "[equation]\nsplit = true\n[plate]\npatch = \"zmin\"\n" +
                    cube_boundary("kind = \"plate-profile\"", "zmin", potential(5)));
  const auto analysis = solved.analysis(comm);

  for (const double u : solved.solution.u) ASSERT_NEAR(u, 0, 1e-12);
  EXPECT_NEAR(analysis.patches[4].charge.value(), 12.100408962, 1e-9);
  EXPECT_NEAR(analysis.energy.value().excess, 0, 1e-12);
}

TEST(Solve, TakesAGivenChargeAndGivesItsPotential) {
  par::Comm comm(MPI_COMM_WORLD);
  const std::string charge = "kind = \"charge\"\nvalue = 1.5";
  Solved solved(comm, test::kuhn_cube(comm, 12),
                "[equation]\nlinear = true\n" + cube_boundary(mirrors, "xmin", charge));
  const auto analysis = solved.analysis(comm);

  // Slab with a mirror at x = 1: psi = 1.5 cosh(1 - x) / sinh(1).
  double at_wall = 0;
  for (std::size_t i = 0; i < solved.domain.point.size(); ++i)
    if (solved.domain.point[i].x == 0) at_wall = std::max(at_wall, solved.solution.u[i]);
  EXPECT_NEAR(comm.max(at_wall), 1.5 * std::cosh(1.0) / std::sinh(1.0), 5e-3);
  EXPECT_NEAR(analysis.patches[0].charge.value(), 1.5, 1e-12);
}

TEST(Solve, TakesAGivenChargeAlikeWhetherTheProfileIsSplitOffOrNot) {
  par::Comm comm(MPI_COMM_WORLD);
  auto walls = cube_boundary(mirrors, "zmin", potential(2));
  walls.replace(walls.find("[boundary.zmax]\n" + mirrors), 16 + mirrors.size(),
                "[boundary.zmax]\nkind = \"charge\"\nvalue = 0.7");
  Solved whole(comm, test::kuhn_cube(comm, 10), walls);
  Solved split(comm, test::kuhn_cube(comm, 10), "[equation]\nsplit = true\n[plate]\npatch = \"zmin\"\n" + walls);

  for (std::size_t i = 0; i < whole.solution.u.size(); ++i)
    ASSERT_NEAR(split.conditions.psi0[i] + split.solution.u[i], whole.solution.u[i], 0.03);
}

TEST(Solve, DecaysThroughAFarFieldWall) {
  par::Comm comm(MPI_COMM_WORLD);
  auto text = cube_boundary(mirrors, "xmin", potential(1));
  text.replace(text.find("[boundary.xmax]\n" + mirrors), 16 + mirrors.size(), "[boundary.xmax]\nkind = \"far-field\"");
  Solved solved(comm, test::kuhn_cube(comm, 10), "[equation]\nlinear = true\n" + text);

  for (std::size_t i = 0; i < solved.domain.point.size(); ++i)
    ASSERT_NEAR(solved.solution.u[i], std::exp(-solved.domain.point[i].x), 3e-3);
}

TEST(Solve, StartsFromAGivenPotential) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved solved(comm, test::kuhn_cube(comm, 5), cube_boundary(mirrors, "zmin", potential(5)));

  const auto again = solved.system.solve(solved.solution.u, [](const NewtonStep&) {});

  EXPECT_EQ(again.newton_iterations, 0);
  EXPECT_TRUE(again.converged);
}

TEST(Solve, SaysWhereTheResidualIsLargestWhenItGivesUp) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved solved(comm, test::kuhn_cube(comm, 4),
                "[solver]\nmax_newton = 1\n" + cube_boundary(mirrors, "zmin", potential(5)));

  EXPECT_FALSE(solved.solution.converged);
  EXPECT_FALSE(solved.solution.reason.empty());
  EXPECT_GE(solved.solution.worst_node, 0);
  EXPECT_GT(solved.solution.worst_residual, 0);
  EXPECT_GT(solved.solution.worst_point.z, 0);  // a node whose potential is not given
}

TEST(Solve, SolvesTheLinearisedEquationToTheChangeOfTheSolution) {
  par::Comm comm(MPI_COMM_WORLD);
  const double step = 1e-4;
  Solved before(comm, test::kuhn_cube(comm, 4), cube_boundary(mirrors, "zmin", potential(2 - step)));
  Solved after(comm, test::kuhn_cube(comm, 4), cube_boundary(mirrors, "zmin", potential(2 + step)));
  Solved at(comm, test::kuhn_cube(comm, 4), cube_boundary(mirrors, "zmin", potential(2)));
  const std::vector<double> no_load(at.solution.u.size(), 0), one(at.solution.u.size(), 1);

  const auto slope = at.system.solve_linearised(no_load, one);

  for (std::size_t i = 0; i < slope.size(); ++i)
    ASSERT_NEAR(slope[i], (after.solution.u[i] - before.solution.u[i]) / (2 * step), 1e-5);
}

TEST(MemoryNeeded, CountsTheEntriesOfTheMatrixFromTheMesh) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 4));
  const auto jacobi = read_case(cube_boundary(potential(1)), "c");
  const auto amg = read_case("[solver]\npreconditioner = \"boomeramg\"\n" + cube_boundary(potential(1)), "c");
  const auto memory = memory_needed(mesh, jacobi);

  const auto n_entries = comm.sum(memory.n_entries);
  if (comm.size() == 1)
    EXPECT_EQ(n_entries, 125 + 2 * 604);  // nodes and edges: 7 n^3 + 9 n^2 + 3 n
  else
    EXPECT_GT(n_entries, 125 + 2 * 604);  // shared rows are counted on every rank
  EXPECT_EQ(memory.mesh, static_cast<std::int64_t>(mesh::bytes_at_rest(mesh)));
  EXPECT_GT(memory.solve, 2 * 12 * memory.n_entries);  // the matrix and its copy with the Jacobian's diagonal
  EXPECT_GT(memory_needed(mesh, amg).solve, memory.solve);
}

TEST(MakeDomain, RefusesPatchesThatDoNotMatch) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 2));
  const auto lacking = read_case("[boundary.xmin]\nkind = \"potential\"\nvalue = 1\n", "c");
  const auto unknown = read_case(cube_boundary(potential(1)) + "[boundary.hull]\nkind = \"symmetry\"\n", "c");

  EXPECT_THROW(make_domain(comm, mesh, lacking, "c"), Error);
  EXPECT_THROW(make_domain(comm, mesh, unknown, "c"), Error);
}

TEST(MakeConditions, CountsNodesWhereGivenPotentialsContradictEachOther) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved solved(comm, test::kuhn_cube(comm, 2), cube_boundary(potential(1), "zmin", potential(2)));

  EXPECT_EQ(solved.conditions.n_contradictions, 8);  // the rim of the bottom, 3 x 3 nodes without its middle
  const auto& patches = solved.domain.mesh->info.patches;
  for (std::size_t p = 0; p < patches.size(); ++p)
    EXPECT_EQ(solved.conditions.contradictions_on[p], patches[p].name == "zmin"   ? 8
                                                      : patches[p].name == "zmax" ? 0
                                                                                  : 3)
        << patches[p].name;
}

TEST(ErrorBars, AreWithheldWhereThePotentialJumps) {
  par::Comm comm(MPI_COMM_WORLD);
  // The charges of the walls that meet grow with each refinement, as the energy does; that of the third has a limit.
  const auto bar_of = [&](const std::string& patch, int order) {
    auto walls = cube_boundary(mirrors, "zmin", potential(2));
    for (const std::string other : {"xmin", "zmax"})
      walls.replace(walls.find("[boundary." + other + "]\n" + mirrors), 16 + mirrors.size(),
                    "[boundary." + other + "]\n" + potential(1));
    Solved solved(comm, test::kuhn_cube(comm, 4),
                  "[solver]\norder = " + std::to_string(order) +
                      "\n[estimator]\ngoals = [\"charge\", \"energy\"]\ngoal_patch = \"" + patch + "\"\n" + walls);
    const auto goals = solved.analysis(comm).goals;
    EXPECT_THAT(goals.at(1).no_error_bar, testing::HasSubstr("infinite")) << "energy";
    EXPECT_FALSE(goals.at(1).is_corrected);
    return goals.at(0).no_error_bar;
  };
  for (const int order : {1, 2})
    for (const std::string patch : {"zmin", "xmin"})
      EXPECT_THAT(bar_of(patch, order), testing::HasSubstr("infinite: patch " + patch)) << order;
  EXPECT_EQ(bar_of("zmax", 2), "");
}

TEST(Harmonic, IsLinearBetweenFlatWallsAndLeavesTheSystemAsItWas) {
  par::Comm comm(MPI_COMM_WORLD);
  for (const std::string quadrature : {"nodal", "gauss"}) {
    Solved solved(comm, test::random_mesh(comm, 6, 2),
                  "[solver]\nquadrature = \"" + quadrature + "\"\n" + cube_boundary(mirrors, "zmin", potential(2)));
    const auto bit = [&](const char* patch) {
      return std::uint64_t{1} << static_cast<unsigned>(solved.domain.patch_number(patch));
    };
    const std::vector<double> load(solved.domain.point.size(), 1);
    const auto before = solved.system.solve_linearised(load, {});

    const auto harmonic = solved.system.harmonic(bit("zmin"), bit("zmax"));
    const auto after = solved.system.solve_linearised(load, {});

    for (std::size_t i = 0; i < harmonic.size(); ++i) {
      ASSERT_NEAR(harmonic[i], 1 - solved.domain.point[i].z, 5e-3);
      ASSERT_NEAR(before[i], after[i], 1e-4);
    }
  }
}

TEST(Solve, StopsWhereTheResidualIsNoNumber) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved solved(comm, test::kuhn_cube(comm, 3), cube_boundary(mirrors, "zmin", potential(2)));
  std::vector<double> start(solved.domain.point.size(), std::nan(""));

  const auto solution = solved.system.solve(start, [](const NewtonStep&) {});

  EXPECT_FALSE(solution.converged);
  EXPECT_NE(solution.reason, "");
}

}  // namespace solve_test
}  // namespace pamr::poisson_boltzmann
