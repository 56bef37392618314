// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/inflow.hpp"

#include <gtest/gtest.h>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/find_patches.hpp"
#include "solvers/dsmc/flow/flow.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/gases.hpp"

namespace pamr::dsmc {
namespace inflow_test {

using Kind = BoundaryCondition::Kind;

TEST(Inflow, LetsInTheShareOfEveryFaceOverManySteps) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 4));
  auto setup = test::box_of(test::nitrogen(), mesh, 1, 400, 1e20, 300, 300, 1e-4);
  const int side = mesh::find_patches(mesh.info.patches, "xmin").at(0);
  for (auto& patch : setup.patch) patch = {Kind::outflow, 0, {}, 1, 1, 1, 1, -1};
  setup.patch[at(side)] = {Kind::inflow, 0, {}, 1, 1, 1, 1, 0};
  setup.stream[0].velocity = {500, 0, 0};
  setup.initial = -1;
  constexpr double share = 2.5;  // particles a step and face: half of one off at least where all are rounded alike
  setup.fnum = molecular_flux(1e20, 300, setup.gas.species[0].mass, 500) / 32 * setup.dt / share;
  const Flow flow(comm, mesh, setup);
  const Inflow inflow(comm, {&flow.domain(), &flow.setup().gas, flow.setup().patch, 3}, flow.setup().stream);
  std::vector<double> expected(at(mesh.n_cells()), 0.0), entered(expected);
  for (const auto& face : flow.domain().boundary)
    if (face.patch == side) expected[at(face.cell)] += share;
  constexpr int n_steps = 256;

  std::vector<Flight> entering;
  for (int step = 0; step < n_steps; ++step) inflow.draw(static_cast<std::uint64_t>(step), entering);

  for (const auto& flight : entering) entered[at(flight.particle.cell)] += 1.0 / n_steps;
  const double error = 0.5 / 16;  // of the mean of 256 numbers that are 2 or 3
  for (std::size_t c = 0; c < expected.size(); ++c)
    EXPECT_NEAR(entered[c], expected[c], 5 * error * expected[c] / share);
}

}  // namespace inflow_test
}  // namespace pamr::dsmc
