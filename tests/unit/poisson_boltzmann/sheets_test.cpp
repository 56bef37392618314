// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/sheets.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

#include "pamr/mesh/inner_patches.hpp"
#include "solved.hpp"
#include "solvers/poisson_boltzmann/report/best_values.hpp"
#include "solvers/poisson_boltzmann/report/pb_report.hpp"
#include "support/error_of.hpp"
#include "support/inner_patch.hpp"

/// Potentials and charges on patches of faces inside.
namespace pamr::poisson_boltzmann {
namespace sheets_test {

using geometry::Vec3;

bool is_anywhere(Vec3) { return true; }
bool is_in_the_middle(Vec3 p) { return std::abs(p.x - 0.5) < 0.25 && std::abs(p.y - 0.5) < 0.25; }

/// The unit cube with a patch of the faces in z = `level` whose centroids it holds.
mesh::DistMesh cube_with_sheet(const par::Comm& comm, int n, double level,
                               const std::function<bool(Vec3)>& holds = is_anywhere) {
  auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, n));
  test::add_inner_patch(mesh, "sheet", [&](Vec3 normal, Vec3 center) {
    return normal.x == 0 && normal.y == 0 && center.z == level && holds(center);
  });
  return mesh;
}

/// Slopes at both ends, and energy, of the potential between two walls in one dimension: by shooting with the method of
/// Runge and Kutta.
struct Profile {
  double first = 0, last = 0, energy = 0;
};
Profile shoot(double low, double slope, double length, bool linear) {
  constexpr int n = 300;
  using Row = std::array<double, 3>;
  const auto rate = [&](const Row& y) {
    return Row{y[1], linear ? y[0] : std::sinh(y[0]),
               0.5 * y[1] * y[1] + (linear ? 0.5 * y[0] * y[0] : std::cosh(y[0]) - 1)};
  };
  Row y{low, slope, 0};
  const double h = length / n;
  for (int i = 0; i < n && std::abs(y[0]) < 30; ++i) {
    const auto moved = [&](const Row& by, double step) {
      return Row{y[0] + step * by[0], y[1] + step * by[1], y[2] + step * by[2]};
    };
    const auto a = rate(y), b = rate(moved(a, h / 2)), c = rate(moved(b, h / 2)), d = rate(moved(c, h));
    for (std::size_t k = 0; k < 3; ++k) y[k] += h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k]);
  }
  return {y[0], y[1], y[2]};
}
Profile between(double low, double high, double length, bool linear) {
  double flat = -100, steep = 100;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (flat + steep);
    (shoot(low, middle, length, linear).first > high ? steep : flat) = middle;
  }
  const auto end = shoot(low, flat, length, linear);
  return {flat, end.last, end.energy};
}

/// The exact values of a sheet between plates at z = 0 and 1.
struct Exact {
  double potential = 0, charge = 0, force = 0, energy = 0;
};
Exact of_potential(double low, double sheet, double high, double level, bool linear) {
  const auto below = between(low, sheet, level, linear), above = between(sheet, high, 1 - level, linear);
  return {sheet, below.last - above.first, 0.5 * (above.first * above.first - below.last * below.last),
          below.energy + above.energy};
}
Exact of_charge(double low, double charge, double high, double level, bool linear) {
  double less = -20, more = 20;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (less + more);
    (of_potential(low, middle, high, level, linear).charge > charge ? more : less) = middle;
  }
  return of_potential(low, less, high, level, linear);
}

std::string case_of(const std::string& head, double low, double high, const std::string& sheet) {
  return head +
         fmt::format(
             "[boundary.zmin]\ncondition = \"potential\"\nvalue = {}\n"
             "[boundary.zmax]\ncondition = \"potential\"\nvalue = {}\n"
             "[boundary.\"*\"]\ncondition = \"symmetry\"\n",
             low, high) +
         (sheet.empty() ? "" : "[boundary.sheet]\n" + sheet);
}

const PatchResult& of_sheet(const Analysis& analysis) { return analysis.patches.back(); }

const GoalResult& goal_named(const Analysis& analysis, const std::string& name) {
  return *std::find_if(analysis.goals.begin(), analysis.goals.end(),
                       [&](const GoalResult& result) { return result.goal.name == name; });
}

void expect_held(const GoalResult& goal, double exact, const std::string& where) {
  ASSERT_TRUE(goal.error_bar) << where << ": " << goal.no_error_bar;
  EXPECT_LE(std::abs(*goal.value + goal.correction - exact), *goal.error_bar) << where << " of " << exact;
  EXPECT_LT(*goal.error_bar, 0.05 * std::max(1.0, std::abs(exact))) << where;
}

/// Both orders of a case, on as many cells as they need.
struct Setting {
  int order, n;
  bool linear;
  std::string head() const {
    return fmt::format("[equation]\nlinear = {}\n[solver]\norder = {}\n", linear ? "true" : "false", order);
  }
};
const std::vector<Setting> settings{{1, 8, true}, {1, 8, false}, {2, 4, true}, {2, 4, false}};

TEST(Sheet, WithAChargeBetweenPlatesHasThePotentialOfTheClosedForm) {
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  constexpr double charge = 2;
  for (const auto& s : settings) {
    const auto text = case_of(s.head() + "[estimator]\ngoals = [\"charge\", \"energy\"]\ngoal_patch = \"zmin\"\n", 0, 0,
                              fmt::format("condition = \"charge\"\nvalue = {}\n", charge));
    const auto exact = of_charge(0, charge, 0, 0.5, s.linear);
    const auto where = s.head();
    if (s.linear) {
      EXPECT_NEAR(exact.potential, charge / 2 * std::tanh(0.5), 1e-8);
    }
    Solved solved(comm, cube_with_sheet(comm, s.n, 0.5), text), serial(alone, cube_with_sheet(alone, s.n, 0.5), text);
    const auto analysis = solved.analysis(comm), of_one = serial.analysis(alone);

    const auto& sheet = of_sheet(analysis);
    EXPECT_NEAR(*sheet.charge, charge, 1e-12) << where;
    EXPECT_NEAR(sheet.area, 1, 1e-12) << where;
    EXPECT_NEAR(sheet.mean_potential, exact.potential, s.order == 1 ? 2e-3 : 2e-5) << where;
    EXPECT_NEAR(sheet.mean_potential, of_sheet(of_one).mean_potential, 1e-9) << where;
    expect_held(goal_named(analysis, "energy"), exact.energy, where + "energy");
    expect_held(goal_named(analysis, "charge"), -between(0, exact.potential, 0.5, s.linear).first, where + "charge");
    EXPECT_NEAR(*goal_named(analysis, "energy").error_bar, *goal_named(of_one, "energy").error_bar, 1e-7) << where;
    EXPECT_NEAR(goal_named(analysis, "charge").correction, goal_named(of_one, "charge").correction, 1e-7) << where;
  }
}

TEST(Sheet, AtAPotentialBetweenPlatesHasTheChargeOfBothSides) {
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  constexpr double low = 0.5, high = -0.3, potential = 1;
  for (const auto& s : settings) {
    const auto text =
        case_of(s.head() + "[estimator]\ngoals = [\"charge\", \"energy\", \"force-z\"]\ngoal_patch = \"sheet\"\n", low,
                high, fmt::format("condition = \"potential\"\nvalue = {}\n", potential));
    const auto exact = of_potential(low, potential, high, 0.25, s.linear);
    const auto where = s.head();
    Solved solved(comm, cube_with_sheet(comm, s.n, 0.25), text), serial(alone, cube_with_sheet(alone, s.n, 0.25), text);
    const auto analysis = solved.analysis(comm), of_one = serial.analysis(alone);

    const auto& sheet = of_sheet(analysis);
    EXPECT_NEAR(*sheet.charge, exact.charge, s.order == 1 ? 0.02 : 1e-3) << where;
    EXPECT_NEAR(*sheet.charge, *of_sheet(of_one).charge, 1e-8) << where;
    EXPECT_NEAR(*sheet.charge_density, *sheet.charge, 1e-12) << where;
    EXPECT_NEAR(sheet.mean_potential, potential, 1e-12) << where;
    expect_held(goal_named(analysis, "charge"), exact.charge, where + "charge");
    expect_held(goal_named(analysis, "energy"), exact.energy, where + "energy");
    if (s.order == 2) {
      expect_held(goal_named(analysis, "force-z"), exact.force, where + "force-z");
    } else {  // a difference of two larger forces
      EXPECT_NEAR(*goal_named(analysis, "force-z").value, exact.force, 0.05) << where;
      EXPECT_THAT(goal_named(analysis, "force-z").no_error_bar, testing::HasSubstr("use order = 2")) << where;
    }
    EXPECT_NEAR(*goal_named(analysis, "charge").error_bar, *goal_named(of_one, "charge").error_bar, 1e-7) << where;
    EXPECT_FALSE(sheet.surface_recovered) << where;
    EXPECT_NEAR(sheet.layer.height, 1.0 / s.n, 1e-12) << where;
  }
}

TEST(Sheet, WithAChargeIsPushedByWhatTheClosedFormSays) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const bool linear : {true, false}) {
    const Setting s{2, 4, linear};
    Solved solved(comm, cube_with_sheet(comm, s.n, 0.25),
                  case_of(s.head() + "[estimator]\ngoals = [\"force-z\", \"energy\"]\ngoal_patch = \"sheet\"\n", 0.5,
                          -0.3, "condition = \"charge\"\nvalue = 2\n"));
    const auto analysis = solved.analysis(comm);

    const auto exact = of_charge(0.5, 2, -0.3, 0.25, linear);
    expect_held(goal_named(analysis, "force-z"), exact.force, s.head() + "force-z");
    expect_held(goal_named(analysis, "energy"), exact.energy, s.head() + "energy");
  }
}

/// Means of one side are not better than gradients of cells, and a net force is the difference of both sides. The value
/// converges with second order.
TEST(Sheet, IsPushedByAForceThatFirstOrderDoesNotCorrect) {
  const par::Comm comm(MPI_COMM_WORLD);
  constexpr double low = 0.5, high = -0.3;
  for (const std::string sheet : {"condition = \"charge\"\nvalue = 2\n", "condition = \"potential\"\nvalue = 1\n"}) {
    const Setting s{1, 8, true};
    Solved solved(comm, cube_with_sheet(comm, s.n, 0.25),
                  case_of(s.head() + "[estimator]\ngoals = [\"force-z\", \"energy\"]\ngoal_patch = \"sheet\"\n", low,
                          high, sheet));
    const auto analysis = solved.analysis(comm);
    const auto& goal = goal_named(analysis, "force-z");
    const auto exact = sheet.find("charge") != std::string::npos ? of_charge(low, 2, high, 0.25, true)
                                                                 : of_potential(low, 1, high, 0.25, true);

    const auto best = best_values(solved.input, analysis, of_sheet(analysis));
    const auto force =
        std::find_if(best.begin(), best.end(), [](const BestValue& b) { return b.quantity == "force-z"; });
    ASSERT_NE(force, best.end());
    EXPECT_EQ(force->value, *goal.value) << sheet;
    EXPECT_TRUE(force->is_goal && !force->is_corrected && !force->error) << sheet;
    EXPECT_NEAR(*goal.value, exact.force, 2e-3) << sheet;
    EXPECT_TRUE(goal_named(analysis, "energy").is_corrected) << sheet;
    const auto lines = describe_results(solved.input, analysis);
    EXPECT_THAT(lines, testing::Contains(testing::HasSubstr("volume, not corrected; no error bar: "))) << sheet;
    const auto report = report_of(solved.domain, solved.input, solved.solution, analysis);
    EXPECT_TRUE(report["goals"][0]["corrected"].is_null()) << report["goals"][0];
    EXPECT_TRUE(report["best"]["sheet"]["force-z"]["error_withheld"].is_string()) << report["best"];
  }
}

TEST(Sheet, HasAnEstimatedErrorOfEachSide) {
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  const auto text = case_of("", 0, 0, "condition = \"charge\"\nvalue = 2\n");
  Solved solved(comm, cube_with_sheet(comm, 8, 0.5), text), serial(alone, cube_with_sheet(alone, 8, 0.5), text);
  const double of_sides = solved.analysis(comm).estimate.total_squared;
  EXPECT_NEAR(of_sides, serial.analysis(alone).estimate.total_squared, 1e-9 * of_sides);

  solved.domain.sides = nullptr;
  EXPECT_GT(solved.analysis(comm).estimate.total_squared, 10 * of_sides);
}

TEST(Sheet, ThatEndsInTheLiquidHasNoBar) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const int order : {1, 2}) {
    Solved solved(
        comm, cube_with_sheet(comm, 4, 0.5, is_in_the_middle),
        case_of(fmt::format("[solver]\norder = {}\n[estimator]\ngoal = \"charge\"\ngoal_patch = \"sheet\"\n", order), 0,
                0, "condition = \"potential\"\nvalue = 1\n"));
    const auto analysis = solved.analysis(comm);

    EXPECT_NEAR(of_sheet(analysis).area, 0.25, 1e-12);
    EXPECT_GT(*of_sheet(analysis).charge, 0.25 * 2 / std::tanh(0.5));  // more at its rim than in the middle
    EXPECT_FALSE(analysis.goals[0].error_bar);
    EXPECT_EQ(analysis.goals[0].no_error_bar, "it does not hold where patch sheet ends in the liquid");
    EXPECT_EQ(analysis.goals[0].is_corrected, order == 2);
  }
}

TEST(Sheet, WithoutATableIsPassedThroughAndSaysSo) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto text = case_of("", 1, -1, "");
  Solved with(comm, cube_with_sheet(comm, 4, 0.5), text), without(comm, test::kuhn_cube(comm, 4), text);

  ASSERT_EQ(with.solution.u.size(), without.solution.u.size());
  for (std::size_t i = 0; i < with.solution.u.size(); ++i) ASSERT_NEAR(with.solution.u[i], without.solution.u[i], 1e-9);
  EXPECT_EQ(with.input.open_inside, std::vector<std::string>{"sheet"});
  EXPECT_THAT(describe(with.input).back(), testing::HasSubstr("sheet: no condition on its faces inside"));
}

TEST(Sheet, IsRefusedWithAnythingButAPotentialOrACharge) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = cube_with_sheet(comm, 2, 0.5);
  const auto refusal = [&](const std::string& text) {
    return test::error_of(
        [&] { with_sheets(comm, resolve_names(read_case(text, "case"), mesh.info.patches, "case"), mesh, "case"); });
  };

  for (const std::string condition : {"symmetry", "far-field", "plate-profile"})
    EXPECT_EQ(refusal(case_of("", 1, 0, "condition = \"" + condition + "\"\n")),
              "case: expected kind = \"potential\" or \"charge\" in [boundary.sheet], whose faces lie inside the "
              "liquid, found \"" +
                  condition + "\" (without a table the liquid goes on through them)");
  EXPECT_THAT(refusal(case_of("[electrolyte]\nconcentration = 1\npH = 6\n", 1, 0,
                              "condition = \"regulated\"\nsite = \"acid\"\nvalue = 1\npK = 5\n")),
              testing::HasSubstr("found \"regulated\""));
  EXPECT_THAT(refusal(case_of("[plate]\npatch = \"sheet\"\n", 1, 0, "condition = \"potential\"\nvalue = 1\n")),
              testing::HasSubstr("expected a patch of the boundary in [plate]"));
  EXPECT_THAT(refusal(case_of("[force]\nmidplane = \"sheet\"\n", 1, 0, "")),
              testing::HasSubstr("expected a mirror of the boundary as midplane"));
  EXPECT_THAT(refusal(case_of("", 1, 0, "") + "[boundary.\"shee*\"]\ncondition = \"charge\"\nvalue = 1\n"),
              testing::HasSubstr("a sheet is named by its own name or that of a group"));
}

TEST(Sheet, MayBeInPartOnTheBoundaryAtAPotentialButNotWithACharge) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = cube_with_sheet(comm, 4, 0.5);
  const auto zmin = static_cast<int>(mesh.info.patches.size()) - 3;
  ASSERT_EQ(mesh.info.patches[at(zmin)].name, "zmin");
  for (auto& word : mesh::make_inner_patches(mesh))
    for (int slot = 0; slot < 4; ++slot)
      if (mesh::inner_patch(word, slot) >= 0) word = mesh::with_inner_patch(word, slot, zmin);
  Solved solved(comm, mesh, case_of("", 1, 1, ""));

  const auto exact = of_potential(1, 1, 1, 0.5, false);
  EXPECT_NEAR(*solved.analysis(comm).patches[at(zmin)].charge, exact.charge - between(1, 1, 0.5, false).first, 0.02);
  EXPECT_EQ(solved.domain.patches[at(zmin)].area, 2);
  EXPECT_THAT(test::error_of([&] {
                Solved(
                    comm, mesh,
                    "[boundary.zmin]\ncondition = \"charge\"\nvalue = 1\n[boundary.\"*\"]\ncondition = \"symmetry\"");
              }),
              testing::HasSubstr("give these a patch of their own"));
}

}  // namespace sheets_test
}  // namespace pamr::poisson_boltzmann
