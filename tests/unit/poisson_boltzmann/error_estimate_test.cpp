// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/error_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "pamr/mark/recovered_error.hpp"
#include "solved.hpp"

namespace pamr::poisson_boltzmann {
namespace error_estimate_test {

const std::string manufactured = "[equation]\nmanufactured = true\n" + cube_boundary("kind = \"manufactured\"");

TEST(Estimate, IsZeroForALinearFunction) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved solved(comm, test::random_mesh(comm, 3, 3), manufactured);
  std::vector<double> linear;
  for (const auto& p : solved.domain.point) linear.push_back(1 + 2 * p.x - 3 * p.y + 0.5 * p.z);

  for (const auto recovery : {Recovery::plain, Recovery::volume_weighted}) {
    const auto gradient = cell_gradients(solved.domain, linear);
    const auto recovered = recover(comm, solved.domain, gradient, recovery);
    for (const double squared : squared_errors(solved.domain, gradient, recovered)) ASSERT_NEAR(squared, 0, 1e-20);
  }
}

TEST(Estimate, AgreesWithTheMarkersOwn) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved solved(comm, test::random_mesh(comm, 5, 3), manufactured);
  const auto analysis = solved.analysis(comm);
  set_fields(solved.mesh, solved.input, solved.solution, analysis);

  const auto error = mark::recovered_error(comm, solved.mesh, "potential");

  EXPECT_NEAR(analysis.estimate.total_squared, error.total_squared, 1e-9 * error.total_squared);
  EXPECT_NEAR(analysis.estimate.norm_squared, error.norm_squared, 1e-9 * error.norm_squared);
  for (std::size_t c = 0; c < error.squared.size(); ++c)
    ASSERT_NEAR(analysis.estimate.squared[c], error.squared[c], 1e-6 * error.squared[c] + 1e-12);
}

TEST(Estimate, ComesNearTheTrueErrorOnASmoothSolution) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved solved(comm, test::kuhn_cube(comm, 10), manufactured);
  const auto analysis = solved.analysis(comm);

  const double effectivity = std::sqrt(analysis.estimate.total_squared) / *analysis.manufactured_h1;

  EXPECT_GT(effectivity, 0.9);
  EXPECT_LT(effectivity, 1.1);
}

TEST(Estimate, DependsOnTheKindOfMean) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved weighted(comm, test::random_mesh(comm, 5, 3), manufactured);
  Solved plain(comm, test::random_mesh(comm, 5, 3), "[estimator]\nrecovery = \"plain\"\n" + manufactured);

  EXPECT_NE(weighted.analysis(comm).estimate.total_squared, plain.analysis(comm).estimate.total_squared);
}

TEST(Goal, PointsToTheMirrorWhoseForceIsAsked) {
  par::Comm comm(MPI_COMM_WORLD);
  auto text = cube_boundary("kind = \"symmetry\"", "xmax", "kind = \"potential\"\nvalue = 2");
  Solved solved(comm, test::kuhn_cube(comm, 6),
                "[force]\nmidplane = \"xmin\"\n[estimator]\ngoal = \"midplane\"\n" + text);

  const auto analysis = solved.analysis(comm);

  ASSERT_EQ(analysis.goal.size(), solved.mesh.cell_to_node.size());
  ASSERT_EQ(analysis.goals.size(), 1U);
  const auto& goal = analysis.goals[0];
  EXPECT_GT(goal.value.value(), 0);
  EXPECT_GT(goal.error_bound, 0);
  // The exact force per area is cosh(psi) - 1 at the mirror; the estimate is no smaller than the true error.
  Solved fine(comm, test::kuhn_cube(comm, 18),
              "[force]\nmidplane = \"xmin\"\n[estimator]\ngoal = \"midplane\"\n" + text);
  EXPECT_LT(std::abs(fine.analysis(comm).goals[0].value.value() - goal.value.value()), goal.error_bound);
}

TEST(Goal, CorrectsEveryQuantityOfASlabAndItsBarHoldsTheTruth) {
  par::Comm comm(MPI_COMM_WORLD);
  // A wall at 2 and its image: the limit is extrapolated from two meshes by the order 2, which is tested.
  const auto walls = cube_boundary("kind = \"symmetry\"", "xmax", "kind = \"potential\"\nvalue = 2") +
                     "[estimator]\ngoals = [\"charge\", \"force-x\", \"energy\"]\ngoal_patch = \"xmax\"\n";
  for (const std::string quadrature : {"nodal", "gauss"}) {
    const auto goals = [&](int n) {
      Solved solved(comm, test::kuhn_cube(comm, n), "[solver]\nquadrature = \"" + quadrature + "\"\n" + walls);
      return solved.analysis(comm).goals;
    };
    const auto coarse = goals(5), fine = goals(10), finest = goals(20);

    ASSERT_EQ(coarse.size(), 3U);
    for (std::size_t g = 0; g < 3; ++g) {
      const double a = coarse[g].value.value(), b = fine[g].value.value(), c = finest[g].value.value();
      EXPECT_NEAR(std::log2((a - b) / (b - c)), 2, 0.25) << quadrature << coarse[g].goal.name;
      const double limit = c + (c - b) / 3;
      EXPECT_LT(std::abs(b + fine[g].correction - limit), 0.5 * std::abs(b - limit)) << quadrature << fine[g].goal.name;
      const bool has_bar = quadrature == "nodal" || fine[g].goal.kind != Goal::Kind::force;
      ASSERT_EQ(fine[g].error_bar.has_value(), has_bar) << quadrature << fine[g].goal.name;
      EXPECT_EQ(fine[g].no_error_bar.empty(), has_bar) << fine[g].no_error_bar;
      EXPECT_LT(std::abs(b + fine[g].correction - limit), fine[g].error_bar.value_or(HUGE_VAL))
          << quadrature << fine[g].goal.name;
    }
  }
}

/// Walls at x = 0 and 1 at these potentials, and the beginning of a table of goals of the latter.
std::string between_walls(const std::string& low, const std::string& high) {
  const std::string mirror = "kind = \"symmetry\"\n", given = "kind = \"potential\"\nvalue = ";
  auto text = cube_boundary(mirror, "xmax", given + high);
  const auto xmin = text.find(mirror);
  return text.replace(xmin, mirror.size(), given + low) + "\n[estimator]\ngoal_patch = \"xmax\"\n";
}

TEST(Goal, CorrectsTheChargeByTheSourceTermBetweenTheNodes) {
  par::Comm comm(MPI_COMM_WORLD);
  // sinh psi is no straight line between the nodes: taken as one, half of the error stayed. A wall at 3, one at 0.
  Solved solved(comm, test::kuhn_cube(comm, 8), between_walls("0", "3") + "goal = \"charge\"\n");
  const auto goal = solved.analysis(comm).goals.at(0);
  const double exact = 4.884421041;  // by shooting (tests/tools/pb_bars_test.py)

  EXPECT_LT(std::abs(*goal.value + goal.correction - exact), 0.1 * std::abs(*goal.value - exact)) << *goal.value;
}

TEST(Goal, CorrectsAForceWhoseCutOffFunctionFallsWithinThreeCells) {
  par::Comm comm(MPI_COMM_WORLD);
  // Means of the dual solution's own gradient smear the cut-off function: corrected, the force was 2.6 times as far
  // from the truth as the value itself.
  Solved solved(comm, test::kuhn_cube(comm, 8), between_walls("-1", "2") + "goal = \"force-x\"\n");
  const auto goal = solved.analysis(comm).goals.at(0);
  const double exact = -3.971903714;  // by shooting

  EXPECT_LT(std::abs(*goal.value + goal.correction - exact), 0.1 * std::abs(*goal.value - exact)) << *goal.value;
  EXPECT_LT(std::abs(*goal.value + goal.correction - exact), goal.error_bar.value());
}

TEST(Goal, HasFurtherOrdersOfNodalQuadratureInItsBarAlone) {
  par::Comm comm(MPI_COMM_WORLD);
  // Nine tenths of the shares are what lumping at the nodes costs, which the correction has: the bar was a third of
  // all.
  Solved solved(comm, test::kuhn_cube(comm, 8), between_walls("-1", "2") + "goals = [\"charge\", \"energy\"]\n");

  for (const auto& goal : solved.analysis(comm).goals) EXPECT_LT(goal.error_bar.value(), 0.2 * goal.error_bound);
}

}  // namespace error_estimate_test
}  // namespace pamr::poisson_boltzmann
