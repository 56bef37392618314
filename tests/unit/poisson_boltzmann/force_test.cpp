// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "pamr/par/reproducible_sum.hpp"
#include "solved.hpp"
#include "solvers/poisson_boltzmann/goals/error_estimate.hpp"
#include "solvers/poisson_boltzmann/goals/midplane_force.hpp"
#include "solvers/poisson_boltzmann/goals/surface_force.hpp"
#include "solvers/poisson_boltzmann/goals/volume_force.hpp"

namespace pamr::poisson_boltzmann {
namespace force_test {

/// A slab between a charged wall at x = 1 and a mirror at x = 0; and the state of any nodal values on it.
class Slab {
 public:
  Slab(const par::Comm& comm, int n, const std::string& more = "", const std::string& wall = "xmax")
      : solved(comm, test::kuhn_cube(comm, n),
               more + cube_boundary("kind = \"symmetry\"", wall, "kind = \"potential\"\nvalue = 2")),
        mirrors(find_mirrors(comm, solved.domain, solved.input)),
        comm_(comm),
        u(solved.solution.u) {}

  template <class Compute>
  auto with_state(Compute&& compute) {
    const auto gradient = cell_gradients(solved.domain, u);
    const auto recovered = recover(comm_, solved.domain, gradient, Recovery::volume_weighted);
    return compute(State{solved.problem, u, solved.solution.reaction, gradient, recovered, mirrors});
  }
  /// Smooth numbers on the nodes, the same on every copy.
  std::vector<double> direction() const {
    std::vector<double> values;
    for (const auto& p : solved.domain.point) values.push_back(std::sin(3 * p.x + 5 * p.y + 7 * p.z));
    return values;
  }
  void move(const std::vector<double>& along, double step) {
    for (std::size_t i = 0; i < u.size(); ++i) u[i] += step * along[i];
  }

  Solved solved;
  std::vector<Mirrors> mirrors;

 private:
  const par::Comm& comm_;

 public:
  std::vector<double> u;
};

double product(const par::Comm& comm, const Domain& domain, const std::vector<double>& a,
               const std::vector<double>& b) {
  par::ExactSum sum;
  for (const auto node : domain.nodes.owned())
    sum.add(a[static_cast<std::size_t>(node)] * b[static_cast<std::size_t>(node)]);
  return par::reproducible_sums(comm, std::span(&sum, 1))[0];
}

TEST(MidplaneForce, IsTheOsmoticPressureBetweenFlatWalls) {
  par::Comm comm(MPI_COMM_WORLD);
  Slab slab(comm, 12);
  const int mirror = slab.solved.domain.patch_number("xmin");

  const double force =
      slab.with_state([&](const State& state) { return midplane_force(comm, state, excess_of(state), mirror); });

  double at_mirror = 0;
  for (std::size_t i = 0; i < slab.u.size(); ++i)
    if (slab.solved.domain.point[i].x == 0) at_mirror = std::max(at_mirror, slab.u[i]);
  EXPECT_NEAR(force, std::cosh(comm.max(at_mirror)) - 1, 0.02);
}

TEST(MidplaneForce, HasItsDerivative) {
  par::Comm comm(MPI_COMM_WORLD);
  for (const std::string equation : {"", "[equation]\nlinear = true\n"}) {
    Slab slab(comm, 4, equation);
    const int mirror = slab.solved.domain.patch_number("xmin");
    const auto along = slab.direction();
    const auto force = [&] {
      return slab.with_state([&](const State& state) { return midplane_force(comm, state, excess_of(state), mirror); });
    };

    const auto derivative =
        slab.with_state([&](const State& state) { return midplane_derivative(comm, state, excess_of(state), mirror); });
    slab.move(along, 1e-4);
    const double above = force();
    slab.move(along, -2e-4);
    const double below = force();

    EXPECT_NEAR(product(comm, slab.solved.domain, derivative, along), (above - below) / 2e-4, 1e-6);
  }
}

TEST(VolumeForce, IsTheFluxOfTheStressThroughTheSlab) {
  par::Comm comm(MPI_COMM_WORLD);
  Slab slab(comm, 12);
  std::vector<double> chi;
  for (const auto& p : slab.solved.domain.point) chi.push_back(p.x);  // 1 on the wall, 0 on the mirror
  const int mirror = slab.solved.domain.patch_number("xmin");

  const auto force = slab.with_state([&](const State& state) { return volume_form(comm, state, chi).force; });

  // What pushes the wall away from the mirror is the pressure there.
  const double pressure =
      slab.with_state([&](const State& state) { return midplane_force(comm, state, excess_of(state), mirror); });
  EXPECT_NEAR(force.x, pressure, 0.01 * pressure);
  EXPECT_NEAR(force.y, 0, 1e-3);
  EXPECT_NEAR(force.z, 0, 1e-3);
}

TEST(VolumeForce, HasTheDerivativesOfForceAndTorque) {
  par::Comm comm(MPI_COMM_WORLD);
  for (const std::string equation :
       {"", "[equation]\nlinear = true\n", "[equation]\nsplit = true\n[plate]\npatch = \"zmin\"\nposition = 0\n"}) {
    const bool split = equation.find("split") != std::string::npos;
    Slab slab(comm, 4, equation, split ? "zmin" : "xmax");
    std::vector<double> chi;
    for (const auto& p : slab.solved.domain.point) chi.push_back(p.x * p.x + 0.3 * p.y);
    const auto along = slab.direction();
    const geometry::Vec3 center{0.2, -0.4, 0.7};
    for (const bool is_torque : {false, true})
      for (int axis = 0; axis < 3; ++axis) {
        const auto value = [&] {
          const auto form =
              slab.with_state([&](const State& state) { return volume_form(comm, state, chi, 0, center); });
          return (is_torque ? form.torque : form.force)[static_cast<std::size_t>(axis)];
        };
        const auto derivative = slab.with_state([&](const State& state) {
          return volume_form_derivative(comm, state, chi, 0, {axis, is_torque, center});
        });
        slab.move(along, 1e-4);
        const double above = value();
        slab.move(along, -2e-4);
        const double below = value();
        slab.move(along, 1e-4);

        EXPECT_NEAR(product(comm, slab.solved.domain, derivative, along), (above - below) / 2e-4, 1e-6)
            << equation << (is_torque ? " torque " : " force ") << axis;
      }
  }
}

TEST(VolumeForce, HasATorqueThatMovesWithItsCenterAsAForceDoes) {
  par::Comm comm(MPI_COMM_WORLD);
  Slab slab(comm, 5);
  std::vector<double> chi;
  for (const auto& p : slab.solved.domain.point) chi.push_back(p.x * p.x * (1 + p.z));
  const geometry::Vec3 a{0, 0, 0}, b{0.3, -1, 2};

  const auto at_a = slab.with_state([&](const State& state) { return volume_form(comm, state, chi, 0, a); });
  const auto at_b = slab.with_state([&](const State& state) { return volume_form(comm, state, chi, 0, b); });

  EXPECT_NEAR(norm(at_a.torque - at_b.torque - cross(b - a, at_a.force)), 0, 1e-10);
  EXPECT_GT(norm(at_a.torque), 0.1);
}

TEST(VolumeForce, OfAPlateHoldsAtAnyPotential) {
  par::Comm comm(MPI_COMM_WORLD);
  // A wall of potential 1 at z = 1 over a plate: the force on the plate tends to a limit as its potential grows.
  const auto force = [&](double plate) {
    const auto text = "[plate]\npatch = \"zmin\"\n[equation]\nsplit = true\n[boundary.zmin]\nkind = \"potential\"\n" +
                      ("value = " + std::to_string(plate)) +
                      "\n[boundary.zmax]\nkind = \"potential\"\nvalue = 1\n[boundary.xmin]\nkind = "
                      "\"symmetry\"\n[boundary.xmax]\nkind = \"symmetry\"\n[boundary.ymin]\nkind = "
                      "\"symmetry\"\n[boundary.ymax]\nkind = \"symmetry\"\n";
    Solved solved(comm, test::kuhn_cube(comm, 8), text);
    return solved.analysis(comm).patches[4].volume.value().z;
  };

  const double at_20 = force(20), at_30 = force(30), at_50 = force(50);

  EXPECT_NEAR(at_30, at_20, 1e-3 * std::abs(at_20));
  EXPECT_NEAR(at_50, at_30, 1e-5 * std::abs(at_30));
}

TEST(SurfaceResults, AgreeOnTheForceOnAFlatWall) {
  par::Comm comm(MPI_COMM_WORLD);
  Slab slab(comm, 16);
  const auto results = slab.solved.analysis(comm).patches;
  const int mirror = slab.solved.domain.patch_number("xmin");
  const double pressure =
      slab.with_state([&](const State& state) { return midplane_force(comm, state, excess_of(state), mirror); });
  const auto& wall = results[1];

  // psi_n^2/2 - (cosh psi - 1) at the wall is minus the pressure at the mirror; the normal points to -x.
  EXPECT_EQ(wall.symmetry_factor, 1);
  EXPECT_NEAR(wall.surface_reaction->x, pressure, 0.02 * pressure);
  EXPECT_NEAR(wall.surface->x, pressure, 0.3 * pressure);
  EXPECT_NEAR(results[0].charge.value(), 0, 1e-12);
  EXPECT_GT(wall.charge.value(), 0);
}

TEST(FindMirrors, CountsOneForEachDirectionThatEndsTheBody) {
  par::Comm comm(MPI_COMM_WORLD);
  Slab slab(comm, 2);
  const auto text =
      "[boundary.xmin]\nkind = \"symmetry\"\n[boundary.ymin]\nkind = \"symmetry\"\n"
      "[boundary.zmin]\nkind = \"potential\"\nvalue = 1\n[boundary.xmax]\nkind = \"far-field\"\n"
      "[boundary.ymax]\nkind = \"far-field\"\n[boundary.zmax]\nkind = \"far-field\"\n";
  const auto corner = read_case(text, "c");

  const auto mirrors = find_mirrors(comm, slab.solved.domain, corner);

  const auto& bottom = mirrors[4];
  EXPECT_EQ(bottom.factor, 4);
  EXPECT_TRUE(bottom.cut[0] && bottom.cut[1] && !bottom.cut[2]);
  EXPECT_EQ(slab.mirrors[1].factor, 1);  // between mirrors on both sides the wall has no end
}

TEST(FindMirrors, CountsTwoPiecesOfOnePlaneOnce) {
  par::Comm comm(MPI_COMM_WORLD);
  Slab slab(comm, 2);
  auto& domain = slab.solved.domain;
  // zmin and zmax as if they lay in one plane beside the charged wall.
  domain.patches[5].level = domain.patches[4].level;

  const auto mirrors = find_mirrors(comm, domain, slab.solved.input);

  EXPECT_TRUE(mirrors[1].cut[2] && !mirrors[1].between[2] && mirrors[1].between[1]);
  EXPECT_EQ(mirrors[1].factor, 2);
}

/// Five walls of a cube at 1 as one body in front of a mirror would have no boundary apart from it; four sides and the
/// bottom, over a lid at 0, have.
std::string cup(const std::string& bodies) {
  std::string text = bodies;
  for (const std::string patch : {"xmin", "xmax", "ymin", "ymax"})
    text += "[boundary." + patch + "]\nkind = \"symmetry\"\n";
  return text +
         "[boundary.zmin]\nkind = \"potential\"\nvalue = 2\n[boundary.zmax]\nkind = \"potential\"\nvalue = "
         "1\n";
}

TEST(Bodies, AreTheSumOfTheirPatches) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved solved(comm, test::kuhn_cube(comm, 6), cup("[[body]]\nname = \"both\"\npatches = [\"zmin\", \"zmax\"]\n"));

  const auto analysis = solved.analysis(comm);

  ASSERT_EQ(analysis.patches.size(), 7U);
  const auto &low = analysis.patches[4], &high = analysis.patches[5], &both = analysis.patches[6];
  EXPECT_EQ(both.name, "both");
  EXPECT_NEAR(both.charge.value(), low.charge.value() + high.charge.value(), 1e-12);
  EXPECT_NEAR(both.surface->z, low.surface->z + high.surface->z, 1e-12);
  EXPECT_NEAR(both.mean_potential, 1.5, 1e-12);
  EXPECT_FALSE(both.volume.has_value());
  EXPECT_NE(both.no_volume, "");
  // Action and reaction between two flat walls.
  EXPECT_NEAR(low.volume->z, -high.volume->z, 0.05 * std::abs(low.volume->z));
}

TEST(Bodies, ThatMeetAnotherHaveNoVolumeFormAndSayWhy) {
  par::Comm comm(MPI_COMM_WORLD);
  Solved solved(comm, test::kuhn_cube(comm, 4),
                cube_boundary("kind = \"symmetry\"", "zmin", "kind = \"potential\"\nvalue = 1") + "[force]\n");
  auto text = cube_boundary("kind = \"potential\"\nvalue = 1");
  Solved all(comm, test::kuhn_cube(comm, 4), text);

  EXPECT_TRUE(solved.analysis(comm).patches[4].volume.has_value());
  const auto results = all.analysis(comm).patches;
  EXPECT_FALSE(results[4].volume.has_value());
  EXPECT_NE(results[4].no_volume.find("meets patch"), std::string::npos);
}

TEST(Layers, CompareTheCellsWithTheGouyChapmanLength) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto layer = [&](double potential, double max_cells) {
    Solved solved(
        comm, test::kuhn_cube(comm, 4),
        cube_boundary("kind = \"symmetry\"", "zmin", "kind = \"potential\"\nvalue = " + std::to_string(potential)));
    const auto analysis = analyze(comm, solved.problem, solved.system, solved.solution, max_cells);
    EXPECT_EQ(analysis.patches[4].charge.has_value(), !analysis.patches[4].layer.is_lost);
    EXPECT_EQ(analysis.energy.has_value(), !analysis.patches[4].layer.is_lost);
    return analysis.patches[4].layer;
  };

  const auto thick = layer(1, 1e8), thin = layer(5, 1e8), lost = layer(12, 1e8);

  EXPECT_NEAR(thick.height, 0.25, 1e-12);
  EXPECT_NEAR(thick.thickness, 1 / std::cosh(0.5), 1e-12);
  EXPECT_TRUE(thick.is_resolved() && !thick.is_lost);
  EXPECT_NEAR(thin.ratio, 0.25 * std::cosh(2.5), 1e-12);
  EXPECT_TRUE(!thin.is_resolved() && !thin.is_lost);
  EXPECT_NEAR(lost.n_cells, 10 * std::cosh(6.0) * std::cosh(6.0), 1e-6 * lost.n_cells);
  EXPECT_TRUE(lost.is_lost);
  EXPECT_TRUE(layer(5, 100).is_lost);
}

TEST(Analysis, KnowsThatItHoldsWhatIsNoNumber) {
  par::Comm comm(MPI_COMM_WORLD);
  Slab slab(comm, 3);
  auto analysis = slab.solved.analysis(comm);
  EXPECT_TRUE(analysis.is_finite());

  auto with_charge = analysis, with_force = analysis, with_energy = analysis;
  with_charge.patches[1].charge = std::nan("");
  with_force.patches[1].volume = geometry::Vec3{0, HUGE_VAL, 0};
  with_energy.energy->total = -HUGE_VAL;

  EXPECT_FALSE(with_charge.is_finite() || with_force.is_finite() || with_energy.is_finite());
}

}  // namespace force_test
}  // namespace pamr::poisson_boltzmann
