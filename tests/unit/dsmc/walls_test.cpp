// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "pamr/assemble/assemble.hpp"
#include "solvers/dsmc/flow/flow.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"
#include "solvers/dsmc/kernel/boundary.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/gases.hpp"

namespace walls_test {

using namespace pamr;
using namespace pamr::dsmc;
using geometry::Vec3;
using Kind = BoundaryCondition::Kind;

BoundaryCondition wall(Kind kind, double temperature, Vec3 velocity = {}) {
  BoundaryCondition condition;
  condition.kind = kind;
  condition.temperature = temperature;
  condition.velocity = velocity;
  return condition;
}

/// Stress along y and heat on the walls x = 0 and x = 1 of a cube of argon without collisions, mirrors on the other
/// sides: Pa and W/m2, positive towards the wall, and the number of hits.
struct Plates {
  double shear[2], heat[2], hits;
};
Plates between_plates(const BoundaryCondition& left, const BoundaryCondition& right, double temperature) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 2));
  const auto gas = test::argon();
  auto setup = test::box_of(gas, mesh, 1, 400, 1e18, temperature, temperature,
                            0.4 / most_probable_speed(temperature, gas.species[0].mass));
  setup.collisions.enabled = false;
  for (std::size_t p = 0; p < setup.patch.size(); ++p) {
    const auto& name = mesh.info.patches[p].name;
    if (name == "xmin") setup.patch[p] = left;
    if (name == "xmax") setup.patch[p] = right;
  }
  Flow flow(comm, mesh, setup);
  flow.fill(mesh);
  for (int step = 0; step < 40; ++step) flow.step();
  flow.start_sampling();
  constexpr int n_steps = 120;
  for (int step = 0; step < n_steps; ++step) flow.step();

  std::int64_t sums[2][3] = {};
  for (std::size_t f = 0; f < flow.surface.face.size(); ++f) {
    const auto& face = flow.domain().boundary[f];
    if (std::fabs(face.normal.x) < 0.5) continue;
    auto* sum = sums[face.normal.x > 0 ? 1 : 0];
    sum[0] += flow.surface.face[f].momentum[1];
    sum[1] += flow.surface.face[f].energy;
    sum[2] += flow.surface.face[f].hits;
  }
  const double scale = setup.fnum / (n_steps * setup.dt);
  Plates plates{{}, {}, static_cast<double>(comm.sum(sums[0][2] + sums[1][2]))};
  for (int side = 0; side < 2; ++side) {
    plates.shear[side] = static_cast<double>(comm.sum(sums[side][0])) * flow.surface.momentum_unit * scale;
    plates.heat[side] = static_cast<double>(comm.sum(sums[side][1])) * flow.surface.energy_unit * scale;
  }
  return plates;
}

TEST(Walls, ConductHeatThroughAFreeMolecularGasAsTheClosedFormSays) {
  const auto plates = between_plates(wall(Kind::diffuse, 373), wall(Kind::diffuse, 273), 320);

  const double error = 4 * 2 * 320 / 100 / std::sqrt(plates.hits);  // a hit carries 2 k T and leaves 0.3 of it
  EXPECT_NEAR(0.5 * (plates.heat[1] - plates.heat[0]) / 0.283110, 1, error);
}

TEST(Walls, ThatMoveDragTheGasAndAreHeatedAsTheClosedFormSays) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 2));
  const auto gas = test::argon();
  const double temperature = 273, density = 1e18, speed = 300, mass = gas.species[0].mass;
  auto setup = test::box_of(gas, mesh, 1, 200, density, temperature, temperature, 1e-3);
  setup.collisions.enabled = false;
  for (std::size_t p = 0; p < setup.patch.size(); ++p) {
    setup.patch[p].kind = Kind::inflow;
    setup.patch[p].stream = 0;
    if (mesh.info.patches[p].name == "xmax") setup.patch[p] = wall(Kind::diffuse, temperature, {0, speed, 0});
  }
  Flow flow(comm, mesh, setup);
  flow.fill(mesh);
  flow.start_sampling();
  constexpr int n_steps = 100;
  for (int step = 0; step < n_steps; ++step) flow.step();

  std::int64_t shear = 0, heat = 0, hits = 0;
  for (const auto& face : flow.surface.face) {
    shear += face.momentum[1];
    heat += face.energy;
    hits += face.hits;
  }
  const double scale = setup.fnum / (n_steps * setup.dt), flux = molecular_flux(density, temperature, mass, 0);
  const double error = 4 / std::sqrt(static_cast<double>(comm.sum(hits)));
  EXPECT_NEAR(flux * mass * speed, 1.89196e-3, 1e-7);
  EXPECT_NEAR(static_cast<double>(comm.sum(shear)) * flow.surface.momentum_unit * scale / -1.89196e-3, 1, 2 * error);
  EXPECT_NEAR(static_cast<double>(comm.sum(heat)) * flow.surface.energy_unit * scale / 0.283793, 1, 4 * error);
}

TEST(Walls, ThatAccommodateHalfConductAndDragAThirdBetweenTwoOfThem) {
  auto left = wall(Kind::diffuse, 373), right = wall(Kind::diffuse, 273);
  left.accommodation = right.accommodation = 0.5;  // 1 / (1/a + 1/a - 1)

  const auto plates = between_plates(left, right, 320);

  EXPECT_NEAR(0.5 * (plates.heat[1] - plates.heat[0]) / (0.283110 / 3), 1, 3 * 4 * 2 * 3.2 / std::sqrt(plates.hits));
}

TEST(Walls, OfCercignaniLampisAndLordReturnTheAccommodationTheyWereGiven) {
  const auto n2 = test::nitrogen().species[0];
  auto cll = wall(Kind::cll, 400, {30, 0, 0});
  cll.normal_accommodation = 0.7;
  cll.tangential_accommodation = 0.4;
  cll.rotational_accommodation = 0.25;
  const double kt = boltzmann * 400, c = most_probable_speed(400, n2.mass);
  const Vec3 normal{0, 0.6, 0.8}, along{1, 0, 0};
  const Motion in{1.5 * c * normal + (2 * c) * along + cll.velocity, 3 * kt};
  Random random(1, Purpose::wall, 0, 0);
  double energy = 0, tangential = 0, rotation = 0, energy_squared = 0;
  constexpr int n = 100000;

  for (int i = 0; i < n; ++i) {
    const auto out = reflect(cll, n2, normal, in, random);
    const double away = -dot(out.velocity, normal) / c;
    ASSERT_GE(away, 0);
    energy += away * away / n;
    energy_squared += std::pow(away, 4) / n;
    tangential += dot(out.velocity - cll.velocity, along) / c / n;
    rotation += out.rotation / kt / n;
  }

  const double error = 4 * std::sqrt(energy_squared / n);
  EXPECT_NEAR(energy, 0.3 * 2.25 + 0.7, error);  // the wall's mean normal energy is k T: 1 in these units
  EXPECT_NEAR(tangential, 0.6 * 2, 4 / std::sqrt(2.0 * n));
  EXPECT_NEAR(rotation, 0.75 * 3 + 0.25, 4 * 2 / std::sqrt(1.0 * n));
}

TEST(Walls, ThatMirrorKeepSpeedAndPlane) {
  const auto n2 = test::nitrogen().species[0];
  Random random(1, Purpose::wall, 0, 0);
  const auto out = reflect(wall(Kind::specular, 0), n2, {0, 0, 1}, {{1, 2, 3}, 4}, random);
  EXPECT_EQ(out.velocity, (Vec3{1, 2, -3}));
  EXPECT_EQ(out.rotation, 4);
}

}  // namespace walls_test
