// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "pamr/par/reproducible_sum.hpp"
#include "solved.hpp"
#include "solvers/poisson_boltzmann/error_estimate.hpp"
#include "solvers/poisson_boltzmann/midplane_force.hpp"
#include "solvers/poisson_boltzmann/surface_force.hpp"
#include "solvers/poisson_boltzmann/volume_force.hpp"

namespace pamr::poisson_boltzmann {
namespace {

/// A slab between a charged wall at x = 1 and a mirror at x = 0; and the state of any nodal values on it.
class Slab {
 public:
  Slab(const par::Comm& comm, int n, const std::string& more = "")
      : solved(comm, test::kuhn_cube(comm, n),
               more + cube_boundary("condition = \"symmetry\"", "xmax", "condition = \"potential\"\nvalue = 2")),
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

  const auto force = slab.with_state([&](const State& state) { return volume_force(comm, state, chi); });

  // What pushes the wall away from the mirror is the pressure there.
  const double pressure =
      slab.with_state([&](const State& state) { return midplane_force(comm, state, excess_of(state), mirror); });
  EXPECT_NEAR(force.x, pressure, 0.01 * pressure);
  EXPECT_NEAR(force.y, 0, 1e-3);
  EXPECT_NEAR(force.z, 0, 1e-3);
}

TEST(VolumeForce, HasItsDerivative) {
  par::Comm comm(MPI_COMM_WORLD);
  Slab slab(comm, 4);
  std::vector<double> chi;
  for (const auto& p : slab.solved.domain.point) chi.push_back(p.x * p.x + 0.3 * p.y);
  const auto along = slab.direction();
  const auto force = [&](int axis) {
    const auto f = slab.with_state([&](const State& state) { return volume_force(comm, state, chi); });
    return f[static_cast<std::size_t>(axis)];
  };
  for (int axis = 0; axis < 3; ++axis) {
    const auto derivative =
        slab.with_state([&](const State& state) { return volume_force_derivative(comm, state, chi, axis); });
    slab.move(along, 1e-4);
    const double above = force(axis);
    slab.move(along, -2e-4);
    const double below = force(axis);
    slab.move(along, 1e-4);

    EXPECT_NEAR(product(comm, slab.solved.domain, derivative, along), (above - below) / 2e-4, 1e-6);
  }
}

TEST(SurfaceResults, AgreeOnTheForceOnAFlatWall) {
  par::Comm comm(MPI_COMM_WORLD);
  Slab slab(comm, 16);
  const auto results = slab.with_state([&](const State& state) { return surface_results(comm, state); });
  const int mirror = slab.solved.domain.patch_number("xmin");
  const double pressure =
      slab.with_state([&](const State& state) { return midplane_force(comm, state, excess_of(state), mirror); });
  const auto& wall = results[1];

  // psi_n^2/2 - (cosh psi - 1) at the wall is minus the pressure at the mirror; the normal points to -x.
  EXPECT_EQ(wall.symmetry_factor, 1);
  EXPECT_NEAR(wall.surface_reaction->x, pressure, 0.02 * pressure);
  EXPECT_NEAR(wall.surface.x, pressure, 0.3 * pressure);
  EXPECT_NEAR(results[0].charge, 0, 1e-12);
  EXPECT_GT(wall.charge, 0);
}

TEST(FindMirrors, CountsOneForEachDirectionThatEndsTheBody) {
  par::Comm comm(MPI_COMM_WORLD);
  Slab slab(comm, 2);
  const auto text =
      "[boundary.xmin]\ncondition = \"symmetry\"\n[boundary.ymin]\ncondition = \"symmetry\"\n"
      "[boundary.zmin]\ncondition = \"potential\"\nvalue = 1\n[boundary.xmax]\ncondition = \"far-field\"\n"
      "[boundary.ymax]\ncondition = \"far-field\"\n[boundary.zmax]\ncondition = \"far-field\"\n";
  const auto corner = read_case(text, "c");

  const auto mirrors = find_mirrors(comm, slab.solved.domain, corner);

  const auto& bottom = mirrors[4];
  EXPECT_EQ(bottom.factor, 4);
  EXPECT_TRUE(bottom.cut[0] && bottom.cut[1] && !bottom.cut[2]);
  EXPECT_EQ(slab.mirrors[1].factor, 1);  // between mirrors on both sides the wall has no end
}

}  // namespace
}  // namespace pamr::poisson_boltzmann
