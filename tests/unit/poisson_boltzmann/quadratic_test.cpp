// SPDX-License-Identifier: GPL-3.0-or-later
// Elements of second order: orders of convergence, on flat and curved boundaries, and forces.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "pamr/adapt/adapt.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "solved.hpp"
#include "solvers/poisson_boltzmann/fem/quadratic_element.hpp"
#include "solvers/poisson_boltzmann/fem/quadratic_elements.hpp"
#include "solvers/poisson_boltzmann/goals/shape_change.hpp"

namespace pamr::poisson_boltzmann {
namespace quadratic_test {

const std::string second_order = "[solver]\norder = 2\n";

Analysis manufactured(const par::Comm& comm, mesh::BlockMesh block) {
  Solved solved(comm, std::move(block),
                "[equation]\nmanufactured = true\n" + second_order + cube_boundary("kind = \"manufactured\""));
  EXPECT_TRUE(solved.solution.converged);
  return solved.analysis(comm);
}

TEST(QuadraticElement, IntegratesPolynomialsOfDegreeFive) {
  for (int a = 0; a <= 5; ++a)
    for (int b = 0; a + b <= 5; ++b)
      for (int c = 0; a + b + c <= 5; ++c) {
        double sum = 0;
        const OfCellNodes<geometry::Vec3> node{{{0, 0, 0},
                                                {1, 0, 0},
                                                {0, 1, 0},
                                                {0, 0, 1},
                                                {0.5, 0, 0},
                                                {0, 0.5, 0},
                                                {0, 0, 0.5},
                                                {0.5, 0.5, 0},
                                                {0.5, 0, 0.5},
                                                {0, 0.5, 0.5}}};
        for (const auto& point : cell_points()) {
          const auto x = place(node, point).position;
          sum += point.weight * std::pow(x.x, a) * std::pow(x.y, b) * std::pow(x.z, c);
        }
        const auto factorial = [](int n) { return std::tgamma(n + 1.0); };
        const double exact = 6 * factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 3);
        EXPECT_NEAR(sum, exact, 1e-14) << a << b << c;
      }
  for (int a = 0; a <= 6; ++a)
    for (int b = 0; a + b <= 6; ++b) {
      double sum = 0;
      for (const auto& point : face_points())
        sum += point.weight * std::pow(point.barycentric[0], a) * std::pow(point.barycentric[1], b);
      EXPECT_NEAR(sum, 2 * std::tgamma(a + 1.0) * std::tgamma(b + 1.0) / std::tgamma(a + b + 3.0), 1e-13) << a << b;
    }
}

TEST(SecondOrder, ConvergesWithOrdersThreeAndTwoOnTheManufacturedSolution) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto coarse = manufactured(comm, test::kuhn_cube(comm, 3)), fine = manufactured(comm, test::kuhn_cube(comm, 6));
  EXPECT_NEAR(std::log2(*coarse.manufactured_l2 / *fine.manufactured_l2), 3, 0.15) << *fine.manufactured_l2;
  EXPECT_NEAR(std::log2(*coarse.manufactured_h1 / *fine.manufactured_h1), 2, 0.1) << *fine.manufactured_h1;
  // the error estimate is that of the gradient, but for what elements of third order leave
  EXPECT_NEAR(std::sqrt(fine.estimate.total_squared) / *fine.manufactured_h1, 1, 0.05);
}

/// The unit sphere by 80 triangles, their corners ascending.
struct Triangles {
  std::vector<geometry::Vec3> point;
  std::vector<std::array<GlobalId, 3>> corner;
};
Triangles icosphere() {
  const double g = std::numbers::phi, r = std::sqrt(1 + g * g);
  Triangles coarse, fine;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-g, g})
      for (const auto& p : std::array<geometry::Vec3, 3>{{{0, a / r, b / r}, {a / r, b / r, 0}, {b / r, 0, a / r}}})
        coarse.point.push_back(p);
  const auto are_near = [&](std::size_t i, std::size_t j) { return norm(coarse.point[i] - coarse.point[j]) < 2.2 / r; };
  fine.point = coarse.point;
  std::map<std::array<std::size_t, 2>, GlobalId> middle;
  for (std::size_t i = 0; i < 12; ++i)
    for (std::size_t j = i + 1; j < 12; ++j)
      if (are_near(i, j)) {
        middle[{i, j}] = std::ssize(fine.point);
        const auto p = fine.point[i] + fine.point[j];
        fine.point.push_back((1 / norm(p)) * p);
      }
  for (std::size_t i = 0; i < 12; ++i)
    for (std::size_t j = i + 1; j < 12; ++j)
      for (std::size_t k = j + 1; k < 12; ++k) {
        if (!are_near(i, j) || !are_near(j, k) || !are_near(i, k)) continue;
        const auto ij = middle[{i, j}], jk = middle[{j, k}], ik = middle[{i, k}];
        const auto a = static_cast<GlobalId>(i), b = static_cast<GlobalId>(j), c = static_cast<GlobalId>(k);
        for (auto triangle :
             std::array<std::array<GlobalId, 3>, 4>{{{a, ij, ik}, {b, ij, jk}, {c, ik, jk}, {ij, jk, ik}}}) {
          std::sort(triangle.begin(), triangle.end());
          fine.corner.push_back(triangle);
        }
      }
  return fine;
}

/// A shell of 1 < r < 1.5: a prism of three cells on each triangle of the sphere.
mesh::BlockMesh shell(const par::Comm& comm) {
  const auto sphere = icosphere();
  const auto n = std::ssize(sphere.point);
  auto nodes = sphere.point;
  for (const auto p : sphere.point) nodes.push_back(1.5 * p);
  std::vector<std::array<GlobalId, 4>> cells;
  mesh::BoundaryTriangles boundary;
  for (const auto& [a, b, c] : sphere.corner) {
    cells.push_back({a, b, c, c + n});
    cells.push_back({a, b, b + n, c + n});
    cells.push_back({a, a + n, b + n, c + n});
    boundary.node.push_back({a, b, c});
    boundary.patch.push_back(0);
    boundary.node.push_back({a + n, b + n, c + n});
    boundary.patch.push_back(1);
  }
  for (auto& cell : cells) {
    geometry::TetPoints p{};
    for (std::size_t i = 0; i < 4; ++i) p[i] = nodes[at(cell[i])];
    if (geometry::volume(p) < 0) std::swap(cell[2], cell[3]);
  }
  auto block = test::small_mesh(comm, nodes, cells);
  block.info.length_unit = "debye";
  block.info.patches = {{"inner", "patch", 0}, {"outer", "patch", 1}};
  block.info.surfaces = test::surfaces_of(
      "[[surface]]\nname = \"inner\"\nkind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n"
      "[[surface]]\nname = \"outer\"\nkind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1.5\n");
  if (comm.is_first()) block.boundary = boundary;
  return block;
}

/// The case on a shell that was refined uniformly so often.
Analysis on_shell(const par::Comm& comm, int n_levels, const std::string& text) {
  auto mesh = assemble::assemble(comm, shell(comm));
  for (int level = 0; level < n_levels; ++level)
    mesh = adapt::refine(comm, mesh, std::vector<std::uint8_t>(at(mesh.n_cells()), 1),
                         {.bend = refine::Bend::none, .parent_field = false})
               .mesh;
  const auto input = read_case(text, "case");
  const auto domain = make_domain(comm, mesh, input, "case");
  const auto conditions = make_conditions(comm, domain, input);
  const Problem problem(domain, input, conditions);
  System system(comm, problem);
  const auto solution = system.solve({}, [](const NewtonStep&) {});
  EXPECT_TRUE(solution.converged);
  auto analysis = analyze(comm, problem, system, solution, 1e8);
  for (auto& patch : analysis.patches) patch.electrode = nullptr;  // it goes with this function
  return analysis;
}

TEST(SecondOrder, GivesTheChargeOfASphereWithOrderFourOnCurvedCells) {
  const par::Comm comm(MPI_COMM_WORLD);
  const std::string text = "[equation]\nlinear = true\n" + second_order +
                           "[boundary.inner]\nkind = \"potential\"\nvalue = 1\n"
                           "[boundary.outer]\nkind = \"potential\"\nvalue = 0\n";
  // psi = sinh(1.5 - r) / (r sinh 0.5); the charge is 4 pi times -psi'(1)
  const double exact = 4 * std::numbers::pi * (1 + 1 / std::tanh(0.5));
  std::vector<double> error;
  for (int level = 0; level <= 2; ++level) {
    const auto analysis = on_shell(comm, level, text);
    error.push_back(std::abs(*analysis.patches[0].charge / exact - 1));
    EXPECT_NEAR(analysis.patches[0].mean_potential, 1, 1e-12);
    EXPECT_LT(norm(*analysis.patches[0].volume), 1e-2 * exact);
  }
  EXPECT_GT(std::log2(error[1] / error[2]), 3.3) << error[0] << " " << error[1] << " " << error[2];
  EXPECT_LT(error[2], 1e-3);
}

/// The goal's value and its corrected value against the exact one.
void expect_corrected(const GoalResult& goal, double exact, double smaller) {
  ASSERT_TRUE(goal.value);
  const double best = *goal.value + goal.correction;
  EXPECT_LT(std::abs(best - exact), smaller * std::abs(*goal.value - exact)) << goal.goal.name << " " << *goal.value;
  ASSERT_TRUE(goal.error_bar) << goal.no_error_bar;
  EXPECT_LE(std::abs(best - exact), *goal.error_bar) << goal.goal.name << " " << best;
  EXPECT_LT(*goal.error_bar, 2 * std::abs(*goal.value - exact)) << goal.goal.name;
}

TEST(SecondOrder, CorrectsChargeAndEnergyOfASphereWithinTheirBars) {
  const par::Comm comm(MPI_COMM_WORLD);
  const std::string text = "[equation]\nlinear = true\n" + second_order +
                           "[estimator]\ngoals = [\"charge\", \"energy\"]\ngoal_patch = \"inner\"\n"
                           "[boundary.inner]\nkind = \"potential\"\nvalue = 1\n"
                           "[boundary.outer]\nkind = \"potential\"\nvalue = 0\n";
  const double exact = 4 * std::numbers::pi * (1 + 1 / std::tanh(0.5));
  for (int level = 0; level <= 1; ++level) {
    const auto analysis = on_shell(comm, level, text);
    expect_corrected(analysis.goals[0], exact, 0.2);
    expect_corrected(analysis.goals[1], exact / 2, 0.2);  // the field's energy: half of charge times potential
  }
}

TEST(SecondOrder, CorrectsForcesWithinTheirBars) {
  const par::Comm comm(MPI_COMM_WORLD);
  std::string text = "[equation]\nlinear = true\n" + second_order +
                     "[estimator]\ngoals = [\"force-x\", \"midplane\"]\ngoal_patch = \"xmin\"\n"
                     "[boundary.xmin]\nkind = \"potential\"\nvalue = 2\n"
                     "[boundary.xmax]\nkind = \"symmetry\"\n[force]\nmidplane = \"xmax\"\n";
  for (const std::string patch : {"ymin", "ymax", "zmin", "zmax"})
    text += "[boundary." + patch + "]\nkind = \"symmetry\"\n";
  const double pressure = 0.5 * 4 / (std::cosh(1.0) * std::cosh(1.0));
  Solved solved(comm, test::kuhn_cube(comm, 3), text);
  const auto analysis = solved.analysis(comm);
  const auto& wall = analysis.patches[0];
  ASSERT_EQ(wall.name, "xmin");
  expect_corrected(analysis.goals[0], std::copysign(wall.symmetry_factor * pressure, wall.volume->x), 0.2);
  expect_corrected(analysis.goals[1], wall.symmetry_factor * pressure, 0.2);
}

TEST(SecondOrder, SolvesTheLinearizedEquationWithGivenValuesAsTheEquation) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const std::string solver : {"order = 1\n", "quadrature = \"gauss\"\n", "order = 2\n"}) {
    Solved solved(comm, test::kuhn_cube(comm, 3),
                  "[equation]\nlinear = true\n[solver]\n" + solver +
                      cube_boundary("kind = \"symmetry\"", "xmin", "kind = \"potential\"\nvalue = 1"));
    const std::vector<double> nothing(solved.domain.point.size(), 0);
    const auto w = solved.system.solve_linearised(nothing, solved.conditions.value);
    for (std::size_t i = 0; i < w.size(); ++i) ASSERT_NEAR(w[i], solved.solution.u[i], 1e-5) << solver << i;
  }
}

/// Half of a slice, 0.5 high, of the liquid between a rod of radius 1 at x = 0.8 and a tube of radius 3: bricks along
/// the half circle, between rod and tube, and along the axis, six cells each.
mesh::BlockMesh rod_in_tube(const par::Comm& comm, GlobalId n_around, GlobalId n_across) {
  std::vector<geometry::Vec3> nodes;
  std::vector<std::array<GlobalId, 3>> place_of;
  for (GlobalId i = 0; i <= n_around; ++i)
    for (GlobalId j = 0; j <= n_across; ++j)
      for (GlobalId k = 0; k <= 1; ++k) {
        const double angle = std::numbers::pi * static_cast<double>(i) / static_cast<double>(n_around);
        const double t = static_cast<double>(j) / static_cast<double>(n_across);
        const double y = i == n_around ? 0 : std::sin(angle);
        nodes.push_back({0.8 * (1 - t) + (1 + 2 * t) * std::cos(angle), (1 + 2 * t) * y, 0.5 * static_cast<double>(k)});
        place_of.push_back({i, j, k});
      }
  const std::array<GlobalId, 3> stride{2 * (n_across + 1), 2, 1};
  std::vector<std::array<GlobalId, 4>> cells;
  std::array<std::size_t, 3> axes{0, 1, 2};
  do {
    for (GlobalId i = 0; i < n_around; ++i)
      for (GlobalId j = 0; j < n_across; ++j) {
        std::array<GlobalId, 4> cell{i * stride[0] + j * stride[1]};
        for (std::size_t k = 0; k < 3; ++k) cell[k + 1] = cell[k] + stride[axes[k]];
        cells.push_back(cell);
      }
  } while (std::next_permutation(axes.begin(), axes.end()));
  mesh::BoundaryTriangles boundary;
  for (auto& cell : cells) {
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const std::array<GlobalId, 3> face{cell[corner == 0 ? 1 : 0], cell[corner <= 1 ? 2 : 1],
                                         cell[corner <= 2 ? 3 : 2]};
      const auto lies = [&](std::size_t axis, GlobalId where) {
        return std::all_of(face.begin(), face.end(), [&](GlobalId node) { return place_of[at(node)][axis] == where; });
      };
      const int patch = lies(1, 0)                        ? 0
                        : lies(1, n_across)               ? 1
                        : lies(0, 0) || lies(0, n_around) ? 2
                        : lies(2, 0)                      ? 3
                                                          : 4;
      if (patch == 4 && !lies(2, 1)) continue;
      boundary.node.push_back(face);
      boundary.patch.push_back(patch);
    }
    geometry::TetPoints p{};
    for (std::size_t i = 0; i < 4; ++i) p[i] = nodes[at(cell[i])];
    if (geometry::volume(p) < 0) std::swap(cell[2], cell[3]);
  }
  auto block = test::small_mesh(comm, nodes, cells);
  block.info.length_unit = "debye";
  block.info.patches = {
      {"rod", "patch", 0}, {"tube", "patch", 1}, {"side", "patch", 2}, {"low", "patch", 3}, {"top", "patch", 4}};
  block.info.surfaces = test::surfaces_of(
      "[[surface]]\nname = \"rod\"\nkind = \"cylinder\"\npoint = [0.8, 0, 0]\naxis = [0, 0, 1]\nradius = 1\n"
      "[[surface]]\nname = \"tube\"\nkind = \"cylinder\"\npoint = [0, 0, 0]\naxis = [0, 0, 1]\nradius = 3\n");
  if (comm.is_first()) block.boundary = boundary;
  return block;
}

TEST(SecondOrder, HasBarsForARodInATubeThatHoldAndAreNotFarTooWide) {
  const par::Comm comm(MPI_COMM_WORLD);
  std::string text = "[equation]\nlinear = true\n" + second_order +
                     "[estimator]\ngoals = [\"force-x\", \"charge\", \"energy\"]\ngoal_patch = \"rod\"\n"
                     "[boundary.rod]\nkind = \"potential\"\nvalue = 2\n"
                     "[boundary.tube]\nkind = \"potential\"\nvalue = -1\n";
  for (const std::string patch : {"side", "low", "top"}) text += "[boundary." + patch + "]\nkind = \"symmetry\"\n";
  const std::array<double, 3> exact{2.882481964, 11.381732821, 8.692401366};  // cases/charged-rod/bessel.py
  for (const GlobalId n : {8, 12}) {
    Solved solved(comm, rod_in_tube(comm, 2 * n, n), text);
    const auto analysis = solved.analysis(comm);
    for (std::size_t g = 0; g < 3; ++g) {
      const auto& goal = analysis.goals[g];
      const double error = std::abs(*goal.value + goal.correction - exact[g]);
      ASSERT_TRUE(goal.error_bar) << goal.no_error_bar;
      EXPECT_LE(error, *goal.error_bar) << goal.goal.name << " " << n;
      EXPECT_LE(*goal.error_bar, 40 * error) << goal.goal.name << " " << n;
    }
  }
}

/// psi = (a exp(r) + b exp(-r)) / r between r = 1 and 1.5, for given values of it or of its slope along r there.
struct InShell {
  double a, b;

  InShell(bool slope_inside, double inside, bool slope_outside, double outside) {
    const auto p = row(slope_inside, 1), q = row(slope_outside, 1.5);
    const double determinant = p[0] * q[1] - p[1] * q[0];
    a = (inside * q[1] - p[1] * outside) / determinant;
    b = (p[0] * outside - inside * q[0]) / determinant;
  }
  static std::array<double, 2> row(bool is_slope, double r) {
    if (is_slope) return {std::exp(r) / r * (1 - 1 / r), -std::exp(-r) / r * (1 + 1 / r)};
    return {std::exp(r) / r, std::exp(-r) / r};
  }
  double at(bool is_slope, double r) const { return a * row(is_slope, r)[0] + b * row(is_slope, r)[1]; }
  double charge_inside() const { return -4 * std::numbers::pi * at(true, 1); }
  double charge_outside() const { return 9 * std::numbers::pi * at(true, 1.5); }
  double energy() const { return 0.5 * (charge_inside() * at(false, 1) + charge_outside() * at(false, 1.5)); }
};

TEST(GivenCharge, OnACurvedWallHasBarsThatHold) {
  const par::Comm comm(MPI_COMM_WORLD);
  struct Case {
    std::string inside, outside, goals;
    InShell exact;
    double charge;
  };
  const auto table = [](const std::string& condition, double value) {
    return "kind = \"" + condition + "\"\n" + (condition == "symmetry" ? "" : fmt::format("value = {}\n", value));
  };
  const InShell both(false, 1, true, 0.5), inner(true, -2, false, -1), closed(false, 2, true, 0);
  const std::array<Case, 3> cases{{
      {table("potential", 1), table("charge", 0.5), "goal_patch = \"inner\"\n", both, both.charge_inside()},
      {table("charge", 2), table("potential", -1), "goal_patch = \"outer\"\n", inner, inner.charge_outside()},
      {table("potential", 2), table("symmetry", 0), "goal_patch = \"inner\"\n", closed, closed.charge_inside()},
  }};
  for (const std::string order : {"1", "2"})
    for (const auto& c : cases)
      for (int level = 0; level <= 1; ++level) {
        const auto analysis = on_shell(comm, level,
                                       "[equation]\nlinear = true\n[solver]\norder = " + order +
                                           "\n[estimator]\ngoals = [\"charge\", \"energy\"]\n" + c.goals +
                                           "[boundary.inner]\n" + c.inside + "[boundary.outer]\n" + c.outside);
        const std::array<double, 2> exact{c.charge, c.exact.energy()};
        for (std::size_t g = 0; g < 2; ++g) {
          const auto& goal = analysis.goals[g];
          const double error = *goal.value + goal.correction - exact[g];
          if (order == "1" && !goal.error_bar) continue;  // cells of half a Debye length
          ASSERT_TRUE(goal.error_bar) << goal.no_error_bar;
          EXPECT_LE(std::abs(error), *goal.error_bar) << order << goal.goal.name << c.outside << level;
          EXPECT_LE(*goal.error_bar, 0.1 * std::abs(exact[g])) << order << goal.goal.name << c.outside << level;
        }
      }
}

TEST(ShapeChange, MeasuresDistanceAndAreaOfASurfaceBesideAFace) {
  const par::Comm comm(MPI_COMM_WORLD);
  Boundary wall;
  wall.condition = Condition::charge;
  const auto surfaces = test::surfaces_of(
      "[[surface]]\nname = \"ball\"\nkind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 2\n"
      "[[surface]]\nname = \"rod\"\nkind = \"cylinder\"\npoint = [0, 0, 0]\naxis = [0, 1, 0]\nradius = 2\n");
  Solved cube(comm, test::kuhn_cube(comm, 1), cube_boundary("kind = \"potential\"\nvalue = 1"));
  for (const geometry::Vec3 point : {geometry::Vec3{0, 0, 1.9}, {0.3, -0.2, 1.9}, {0.5, 0.5, 2.1}}) {
    // A face normal to z. A projection along radii shrinks areas by the square of the radius, on a rod by the radius.
    const double r = norm(point), s = std::hypot(point.x, point.z), tilt = point.z / r, tilt_of_rod = point.z / s;
    const auto ball = wall_shift(cube.domain, wall, *surfaces->surface[0], {point, {0, 0, 1}}, 0.1);
    EXPECT_NEAR(ball.stretch, tilt * 4 / (r * r) - 1, 1e-7);
    EXPECT_NEAR(ball.distance, -(2 - r) * tilt, 1e-14);
    const auto rod = wall_shift(cube.domain, wall, *surfaces->surface[1], {point, {0, 0, -1}}, 0.1);
    EXPECT_NEAR(rod.stretch, tilt_of_rod * 2 / s - 1, 1e-7);
    EXPECT_NEAR(rod.distance, (2 - s) * tilt_of_rod, 1e-14);
  }
}

TEST(ShapeChange, FindsTheChargeThatChordsOfACurvedEdgeMiss) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const double radius : {1.5, 3.0, 10.0}) {
    // The side x = 0 stands for a cylinder through its corners, so that zmin and zmax lack a segment of a circle each.
    const double half_angle = std::asin(0.5 / radius);
    auto block = test::kuhn_cube(comm, 1);
    block.info.surfaces = test::surfaces_of(fmt::format(
        "[[surface]]\nname = \"bow\"\nkind = \"cylinder\"\npoint = [{}, 0.5, 0]\naxis = [0, 0, 1]\nradius = {}\n",
        radius * std::cos(half_angle), radius));
    for (auto& patch : block.info.patches)
      if (patch.name == "xmin") patch.surface = 0;
    Solved cube(comm, std::move(block),
                cube_boundary("kind = \"potential\"\nvalue = 1", "zmin", "kind = \"charge\"\nvalue = -3"));
    const std::vector<double> w(cube.domain.point.size(), 0.5);
    const double segment = radius * radius * (half_angle - 0.5 * std::sin(2 * half_angle));
    const State state{cube.problem, cube.solution.u, cube.solution.reaction, {}, {}, {}};
    EXPECT_NEAR(charge_at_edges(comm, state, 0, w) / (1.5 * segment), 1, 0.05) << radius;
    // Where the goal counts the charge itself, w less 1.
    const auto zmin = std::uint64_t{1} << static_cast<unsigned>(cube.domain.patch_number("zmin"));
    EXPECT_NEAR(charge_at_edges(comm, state, zmin, std::vector<double>(w.size(), 0.9)) / (0.3 * segment), 1, 0.05);
  }
}

TEST(FarField, IsInTheBarWithWhatItLacksToTheLiquidBeyond) {
  const par::Comm comm(MPI_COMM_WORLD);
  struct Case {
    double potential;
    bool is_linear, has_sphere;
    double charge;  // without walls: inward integration of the spherical equation, and exp(1 - r)/r
  };
  for (const auto& c : {Case{1, true, false, 2}, Case{1, false, false, 2.029693916}, Case{3, false, true, 6.937467235},
                        Case{1, true, true, 2}}) {
    const auto analysis =
        on_shell(comm, 1,
                 fmt::format("[equation]\nlinear = {}\n{}[estimator]\ngoal = \"charge\"\ngoal_patch = \"inner\"\n"
                             "[boundary.inner]\nkind = \"potential\"\nvalue = {}\n[boundary.outer]\nkind = "
                             "\"far-field\"\n{}",
                             c.is_linear, second_order, c.potential,
                             c.has_sphere ? "[[sphere]]\npatch = \"inner\"\ncenter = [0, 0, 0]\nradius = 1\n" : ""));
    const auto& goal = analysis.goals[0];
    const double error = std::abs(*goal.value + goal.correction - 4 * std::numbers::pi * c.charge);
    EXPECT_LE(error, *goal.error_bar) << c.potential << c.is_linear << c.has_sphere;
    if (c.is_linear && c.has_sphere)
      EXPECT_LT(goal.of_box, 1e-3 * *goal.value);  // the condition is exact
    else
      EXPECT_LT(goal.of_box, 3 * error);
  }
}

TEST(SecondOrder, AgreesOnAnyNumberOfRanks) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const std::string text = second_order +
                           "[estimator]\ngoal = \"energy\"\n"
                           "[boundary.inner]\nkind = \"charge\"\nvalue = 3\n"
                           "[boundary.outer]\nkind = \"far-field\"\n";
  const auto here = on_shell(world, 0, text), alone = on_shell(self, 0, text);
  EXPECT_NEAR(*here.patches[1].charge / *alone.patches[1].charge, 1, 1e-9);
  EXPECT_NEAR(here.energy->total / alone.energy->total, 1, 1e-9);
  EXPECT_NEAR(here.patches[0].mean_potential / alone.patches[0].mean_potential, 1, 1e-9);
  EXPECT_NEAR(*alone.patches[0].charge, 3 * alone.patches[0].area, 1e-9);
  EXPECT_NEAR(here.estimate.total_squared / alone.estimate.total_squared, 1, 1e-6);
  EXPECT_NEAR(here.goals[0].correction / alone.goals[0].correction, 1, 1e-6);
  ASSERT_TRUE(here.goals[0].error_bar);
  EXPECT_NEAR(*here.goals[0].error_bar / *alone.goals[0].error_bar, 1, 1e-6);
  EXPECT_NEAR(here.goals[0].error_bound / alone.goals[0].error_bound, 1, 1e-6);
}

TEST(SecondOrder, GivesTheForceBetweenFlatWalls) {
  const par::Comm comm(MPI_COMM_WORLD);
  const std::string walls = "[equation]\nlinear = true\n" + second_order +
                            "[boundary.xmin]\nkind = \"potential\"\nvalue = 2\n"
                            "[boundary.xmax]\nkind = \"symmetry\"\n[force]\nmidplane = \"xmax\"\n";
  std::string sides;
  for (const std::string patch : {"ymin", "ymax", "zmin", "zmax"})
    sides += "[boundary." + patch + "]\nkind = \"symmetry\"\n";
  Solved solved(comm, test::kuhn_cube(comm, 4), walls + sides);
  const auto analysis = solved.analysis(comm);
  // psi = 2 cosh(1 - x) / cosh 1: the pressure on the mirror is psi(1)^2/2, the charge 2 tanh 1
  const double pressure = 0.5 * 4 / (std::cosh(1.0) * std::cosh(1.0));
  bool found = false;
  for (const auto& patch : analysis.patches) {
    if (patch.name != "xmin") continue;
    found = true;
    EXPECT_NEAR(*patch.charge, 2 * std::tanh(1.0), 1e-5);
    ASSERT_TRUE(patch.volume);
    EXPECT_NEAR(std::abs(patch.volume->x), patch.symmetry_factor * pressure, 1e-4);
    ASSERT_TRUE(patch.midplane);
    EXPECT_NEAR(std::abs(patch.midplane->x), patch.symmetry_factor * pressure, 1e-4);
  }
  EXPECT_TRUE(found);
}

TEST(SecondOrder, RefusesWhatItDoesNotHave) {
  const auto boundary = cube_boundary("kind = \"potential\"\nvalue = 1");
  EXPECT_THROW(read_case("[solver]\norder = 3\n" + boundary, "case"), Error);
  EXPECT_THROW(read_case("[solver]\norder = 2\nquadrature = \"gauss\"\n" + boundary, "case"), Error);
}

}  // namespace quadratic_test
}  // namespace pamr::poisson_boltzmann
