// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/periodic.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/gases.hpp"

namespace periodic_test {

using namespace pamr;
using namespace pamr::dsmc;
using geometry::Vec3;
using test::totals;
using Kind = BoundaryCondition::Kind;

/// Joins the sides of Kuhn's cube (xmin, xmax, ymin, ...) along the first `n_axes` axes.
void join(Setup& setup, int n_axes) {
  for (int side = 0; side < 2 * n_axes; ++side) {
    auto& patch = setup.patch[static_cast<std::size_t>(side)];
    patch.kind = Kind::periodic;
    patch.partner = side ^ 1;
  }
}

/// Every particle with all its bits and its cell, whatever their order and their ranks.
std::int64_t fingerprint(const Flow& flow) {
  std::uint64_t sum = 0;
  const auto& p = flow.particles;
  for (std::size_t i = 0; i < p.size(); ++i) {
    std::uint64_t h = p.id[i];
    for (const double value : {p.x[i], p.y[i], p.z[i], p.u[i], p.v[i], p.w[i], p.rotation[i]})
      h = combine(h, bits_of(value));
    sum += combine(h, static_cast<std::uint64_t>(flow.domain().cell_global[static_cast<std::size_t>(p.cell[i])]));
  }
  return flow.comm().sum(static_cast<std::int64_t>(sum));
}

Setup wind_in_a_box(const mesh::DistMesh& mesh, double dt) {
  auto setup = test::box_of(test::nitrogen(), mesh, 1, 20, 1e20, 300, 300, dt);
  setup.stream[0].velocity = {900, 400, -250};
  join(setup, 3);
  return setup;
}

TEST(Periodic, FlightsEndWhereTheUnfoldedStraightLineDoesAndNoneIsLostOnAnyNumberOfRanks) {
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  const auto block = test::kuhn_cube(comm, 3);
  const auto mesh = assemble::assemble(comm, block), whole = assemble::assemble(alone, test::gather(comm, block));
  auto setup = wind_in_a_box(mesh, 1.7e-3);  // more than a passage of the box in a step
  setup.collisions.enabled = false;
  Flow flow(comm, mesh, setup), twin(alone, whole, setup);
  flow.fill(mesh);
  twin.fill(whole);
  const auto start = twin.particles;
  std::vector<std::size_t> at(start.size());
  for (std::size_t i = 0; i < start.size(); ++i) at[start.id[i]] = i;

  constexpr int n_steps = 20;
  for (int step = 0; step < n_steps; ++step) {
    flow.step();
    twin.step();
  }

  EXPECT_EQ(flow.n_particles(), static_cast<std::int64_t>(start.size()));
  const auto& p = flow.particles;
  double worst = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto k = at[p.id[i]];
    EXPECT_EQ(p.velocity(i).x, start.velocity(k).x);
    const Vec3 off = p.position(i) - start.position(k) - (n_steps * setup.dt) * start.velocity(k);
    for (const double x : {off.x, off.y, off.z}) worst = std::max(worst, std::fabs(x - std::round(x)));
    EXPECT_TRUE(is_inside(flow.domain(), p.cell[i], p.position(i), 1e-13));
  }
  EXPECT_LE(worst, 1e-12);
  EXPECT_EQ(fingerprint(flow), alone.sum(fingerprint(twin)));
}

TEST(Periodic, AStreamWithCollisionsKeepsItsMomentumAndEnergyAndItsBitsOnAnyNumberOfRanks) {
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  const auto block = test::kuhn_cube(comm, 4);
  const auto mesh = assemble::assemble(comm, block), whole = assemble::assemble(alone, test::gather(comm, block));
  const auto setup = wind_in_a_box(mesh, 1e-4);
  Flow flow(comm, mesh, setup), twin(alone, whole, setup);
  flow.fill(mesh);
  twin.fill(whole);
  const auto before = totals(flow);

  std::int64_t collisions = 0, crossings = 0;
  for (int step = 0; step < 40; ++step) {
    const auto counts = flow.step();
    collisions += counts.collided.collisions;
    crossings += counts.moved.left + counts.entered + counts.moved.wall_hits;
    twin.step();
  }

  const auto after = totals(flow);
  EXPECT_GT(comm.sum(collisions), 1000);
  EXPECT_EQ(crossings, 0);
  EXPECT_EQ(after.n, before.n);
  const double momentum = norm(before.momentum);
  EXPECT_LE(norm(after.momentum - before.momentum), 1e-12 * momentum);
  EXPECT_NEAR((after.translational + after.rotational) / (before.translational + before.rotational), 1, 1e-12);
  EXPECT_EQ(fingerprint(flow), fingerprint(twin));
}

TEST(Periodic, ParticlesCrossBetweenCellsOfUnlikeStepsAndStayInTheirCells) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 4));
  auto setup = wind_in_a_box(mesh, 2e-4);
  setup.collisions.enabled = false;
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {  // half the step in the left half
    const auto points = corners(mesh, 1, cell);
    setup.cell_dt.push_back(0.25 * (points[0].x + points[1].x + points[2].x + points[3].x) < 0.5 ? 1e-4 : 2e-4);
  }
  Flow flow(comm, mesh, setup);
  flow.fill(mesh);
  const auto n = flow.n_particles();

  double left = 0;
  for (int step = 0; step < 60; ++step) {
    flow.step();
    for (std::size_t i = 0; i < flow.particles.size(); ++i) {
      EXPECT_TRUE(is_inside(flow.domain(), flow.particles.cell[i], flow.particles.position(i), 1e-13));
      if (flow.particles.x[i] < 0.5) left += 1.0 / 60;
    }
  }

  EXPECT_EQ(flow.n_particles(), n);
  const auto all = par::reproducible_sum(comm, std::vector<double>{left});
  const auto expected = 2.0 / 3 * static_cast<double>(n);  // steps and weights are half as large there
  EXPECT_NEAR(all / expected, 1, 4 / std::sqrt(static_cast<double>(n)));
}

TEST(Periodic, PatchesWhoseFacesDoNotMatchAreRefusedOnEveryRankWithTheNameOfAFace) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 3));
  auto setup = wind_in_a_box(mesh, 1e-4);
  for (auto& patch : setup.patch) patch = {};
  for (const int side : {0, 2}) {  // xmin and ymin
    setup.patch[static_cast<std::size_t>(side)].kind = Kind::periodic;
    setup.patch[static_cast<std::size_t>(side)].partner = 2 - side;
  }

  try {
    Flow flow(comm, mesh, setup);
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("\"xmin\""));
    EXPECT_THAT(error.what(), testing::HasSubstr("\"ymin\""));
    EXPECT_THAT(error.what(), testing::HasSubstr("face of cell"));
  }
}

}  // namespace periodic_test
